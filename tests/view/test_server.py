"""The server without a browser: who gets in, what is given, and where it listens."""

from collections.abc import Iterator
import http.client
import json
import select
import socket
import threading
import time

from isa_ros.errors import ConfigError
from isa_ros.view.hub import Hub, MOST_VIEWERS
from isa_ros.view.server import serving
import pytest

_TIMEOUT = 20.0


class Client:
    """Requests as a browser makes them, with headers that a test changes."""

    def __init__(self, hub: Hub, url: str) -> None:
        self.hub, self.url = hub, url
        _, _, self.host, self.token, _ = url.split('/')

    def ask(self, path='', body=None, token=None, **headers):
        connection = http.client.HTTPConnection(self.host, timeout=_TIMEOUT)
        connection.putrequest('GET' if body is None else 'POST',
                              f'/{self.token if token is None else token}/{path}',
                              skip_host=True)
        own = {'Host': self.host}
        if body is not None:
            own |= {'Origin': f'http://{self.host}', 'Content-Type': 'application/json',
                    'Content-Length': str(len(body))}
        for name, value in {**own, **{k.replace('_', '-'): v for k, v in headers.items()}}.items():
            if value is not None:
                connection.putheader(name, value)
        connection.endheaders(body)
        return connection.getresponse()

    def order(self, body=b'{"what": "pause", "value": true}', **headers):
        answer = self.ask('order', body, **headers)
        return answer.status, answer.read().decode()


@pytest.fixture
def client() -> Iterator[Client]:
    hub = Hub({'title': '</script>'})
    with serving(hub, 0) as url:
        yield Client(hub, url)


def test_the_page_and_its_parts_are_given_with_their_policy(client):
    kinds = {'': 'text/html', 'page.css': 'text/css', 'page.js': 'text/javascript',
             'controls.js': 'text/javascript', 'scene.js': 'text/javascript',
             'plots.js': 'text/javascript',
             'elements.js': 'text/javascript',
             'signals.js': 'text/javascript', 'uplot.js': 'text/javascript',
             'uplot.css': 'text/css', 'page.json': 'application/json'}
    for path, kind in kinds.items():
        answer = client.ask(path)
        assert (answer.status, answer.headers['Content-Type']) == (200, f'{kind}; charset=utf-8')
        assert len(answer.read()) == int(answer.headers['Content-Length']) > 10
        policy = answer.headers['Content-Security-Policy']
        assert "default-src 'none'; script-src 'self'; " in policy and 'unsafe' not in policy
        assert "frame-ancestors 'none'" in policy
        assert answer.headers['X-Content-Type-Options'] == 'nosniff'
        assert answer.headers['Referrer-Policy'] == 'no-referrer'
        assert answer.headers['Cache-Control'] == 'no-store'
    assert client.ask('other').status == 404
    assert client.ask('../server.py').status == client.ask('page.js/').status == 404


def test_the_page_has_the_licence_of_what_draws_it_and_no_script_of_its_own(client):
    assert b'The MIT License' in client.ask('uplot.js').read(2000)
    page = client.ask().read().decode()
    assert page.count('<script') == page.count('<script src="') == page.count('</script>') == 7
    assert 'style=' not in page and 'http' not in page


@pytest.mark.parametrize('changed', [
    {'token': ''}, {'token': 'x'}, {'Host': None}, {'Host': 'evil.org'}, {'Host': 'localhost'},
    {'Origin': 'http://evil.org'}, {'Origin': 'null'}])
@pytest.mark.parametrize('path', ['', 'page.json', 'frames', 'order', 'page.js'])
def test_without_the_token_or_from_elsewhere_everything_is_refused(client, path, changed):
    answer = client.ask(path, **changed)
    assert (answer.status, answer.read()) == (
        403, b'open the address that isa view has printed')
    assert not client.hub.has_viewers
    assert client.ask(path, b'{"what": "restart"}', **changed).status == 403
    assert client.hub.taken() == []


@pytest.mark.parametrize('method', ['HEAD', 'PUT', 'OPTIONS', 'TRACE', 'X'])
def test_other_methods_are_refused_and_without_the_token_at_first(client, method):
    own = {'Origin': f'http://{client.host}'}
    for token, headers, status in (('x', own, 403), (client.token, {'Host': 'evil.org'}, 403),
                                   (client.token, {}, 403), (client.token, own, 405)):
        connection = http.client.HTTPConnection(client.host, timeout=_TIMEOUT)
        connection.request(method, f'/{token}/', headers=headers)
        answer = connection.getresponse()
        assert (answer.status, answer.headers['Allow'], answer.headers['Connection']) == (
            status, 'GET, POST' if status == 405 else None, 'close')
        assert answer.headers['X-Content-Type-Options'] == 'nosniff'
        begin = answer.read()[:4]
        assert begin == b'' if method == 'HEAD' else begin in (b'open', b'must')


def test_the_answer_to_head_has_no_body(client):
    name, port = client.host.split(':')
    with socket.create_connection((name, int(port)), _TIMEOUT) as own:
        own.sendall(f'HEAD / HTTP/1.1\r\nHost: {client.host}\r\n\r\n'.encode())
        answer = own.makefile('rb').read()
    assert answer.startswith(b'HTTP/1.1 403 ') and answer.endswith(b'\r\n\r\n')


def test_what_is_no_request_is_refused_without_a_page(client):
    name, port = client.host.split(':')
    with socket.create_connection((name, int(port)), _TIMEOUT) as own:
        own.sendall(b'GET / HTTP/1.1\r\n' + b'a: b\r\n' * 110 + b'\r\n')
        answer = own.makefile('rb').read()
    assert answer.startswith(b'HTTP/1.1 431 ') and answer.endswith(b'\r\n\r\n')


def test_an_order_of_the_page_is_taken(client):
    assert client.order() == (204, '')
    assert client.order(b'{"what": "step", "value": 3, "number": 8}') == (204, '')
    assert [(own.what, own.value, own.number) for own in client.hub.taken()] == [
        ('pause', True, 0), ('step', 3, 8)]


@pytest.mark.parametrize('headers, status', [
    ({'Origin': None}, 403), ({'Content_Type': 'text/plain'}, 400), ({'Content_Type': None}, 400),
    ({'Content_Length': '0'}, 400), ({'Content_Length': None}, 400),
    ({'Content_Length': '4097'}, 400), ({'Content_Length': '-1'}, 400),
    ({'Content_Length': '1' * 5000}, 400), ({'Content_Length': '1_0'}, 400),
    ({'Content_Length': '\u0663'.encode()}, 400)])
def test_an_order_of_another_page_or_without_its_form_is_refused(client, headers, status):
    if 'Content_Type' in headers or 'Content_Length' in headers:
        headers = {name.replace('_', '-'): value for name, value in headers.items()}
    found, text = client.order(**headers)
    assert found == status
    assert text.startswith('an order ' if status == 400 else 'open the address')
    assert ('1 to 4096 bytes' in text) == ('Content-Length' in headers)
    assert client.hub.taken() == []


def test_a_bad_order_is_refused_in_words(client):
    assert client.order(b'{"what": "speed", "value": -2}') == (
        400, 'speed: value = -2, must be a number from 0 to 1000')
    assert client.ask('page.json', b'{}').status == 404


def test_frames_are_a_stream_of_events_until_the_end():
    hub = Hub({})
    with serving(hub, 0) as url:
        answer = Client(hub, url).ask('frames')
        assert (answer.status, answer.headers['Content-Type']) == (
            200, 'text/event-stream; charset=utf-8')
        assert hub.was_opened.wait(_TIMEOUT)
        hub.send(b'data: 1\n\n')
        assert answer.readline() == b'data: 1\n'
        hub.send(b'data: 2\n\n')
    assert answer.read() == b'\ndata: 2\n\n'
    assert not hub.has_viewers


def test_a_closed_page_is_forgotten_and_one_too_many_is_told(client):
    pages = [client.ask('frames') for _ in range(MOST_VIEWERS)]
    refused = client.ask('frames')
    assert (refused.status, refused.read()) == (503, b'too many pages are open')
    pages[0].close()
    answer, ended = None, threading.Event()
    threading.Timer(_TIMEOUT, ended.set).start()
    while not ended.is_set():
        client.hub.send(b'data: {}\n\n')
        answer = client.ask('frames')
        if answer.status == 200:
            break
    assert answer is not None and answer.status == 200


def test_nothing_listens_beyond_this_host(client):
    """A connection to another address of this host is refused, as one from the network is."""
    name, port = client.host.split(':')
    assert name == '127.0.0.1'
    for other in ('127.0.0.2', *_other_addresses()):
        with socket.socket() as own, pytest.raises(OSError):
            own.settimeout(_TIMEOUT)
            own.connect((other, int(port)))


def _other_addresses() -> list[str]:
    """Return the address of this host by which it reaches others, if it has one."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as own:
        try:
            own.connect(('192.0.2.1', 9))       # sends nothing
        except OSError:
            return []
        return [own.getsockname()[0]]


def test_a_port_that_is_taken_is_refused_in_one_line():
    with serving(Hub({}), 0) as url:
        port = int(url.split(':')[2].split('/')[0])
        with pytest.raises(ConfigError, match=f'^--port {port}: cannot listen at 127.0.0.1: '):
            with serving(Hub({}), port):
                pass


def test_what_a_page_gets_first_is_json(client):
    assert json.loads(client.ask('page.json').read()) == {'title': '</script>'}


def test_connections_are_so_many_and_no_more(client):
    """Each costs a thread and a descriptor of the run before its token is read."""
    address = (client.host.partition(':')[0], int(client.host.partition(':')[2]))
    silent = [socket.create_connection(address, _TIMEOUT) for _ in range(70)]
    try:
        assert wait_until(lambda: len(select.select(silent, [], [], 0.0)[0]) == 70 - 64)
        assert len(select.select(silent, [], [], 0.0)[0]) == 70 - 64    # ended by the server
    finally:
        for one in silent:
            one.close()
    assert wait_until(lambda: client.order()[0] == 204)


def wait_until(is_done) -> bool:
    """Return whether something came true within the time of a request."""
    end = time.monotonic() + _TIMEOUT
    while time.monotonic() < end:
        try:
            if is_done():
                return True
        except OSError:
            pass
        time.sleep(0.02)
    return False
