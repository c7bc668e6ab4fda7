"""
The server of the page: standard library only, on the loopback interface only.

GET gives the page, its parts and the stream of frames; POST takes orders. A page loads nothing
from elsewhere, and its Content-Security-Policy runs no script but the files of this server, so
that markup in a name of a hostile bag, should any ever get through, could not run.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
import re
from threading import BoundedSemaphore, Thread
from typing import Any

from isa_ros.analysis import report
from isa_ros.errors import ConfigError, SetpointError
from isa_ros.vendor import uplot
from isa_ros.view.access import Access, HOST
from isa_ros.view.hub import Hub
from isa_ros.view.orders import MOST_BYTES, order_of

_BROWSER = Path(__file__).parent / 'browser'
_OF_REPORT = Path(report.__file__).parent / 'browser'
"""What a report's page has, too: elements, and samples thinned for drawing."""
_HTML, _SCRIPT, _STYLE = 'text/html', 'text/javascript', 'text/css'
_FILES = {
    '': (_BROWSER / 'index.html', _HTML), 'page.css': (_BROWSER / 'page.css', _STYLE),
    **{name: (_OF_REPORT / name, _SCRIPT) for name in ('elements.js', 'signals.js')},
    **{name: (_BROWSER / name, _SCRIPT)
       for name in ('scene.js', 'plots.js', 'controls.js', 'page.js')}}
_HEADERS = {
    'Content-Security-Policy': (
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"),
    'X-Content-Type-Options': 'nosniff', 'Referrer-Policy': 'no-referrer',
    'Cross-Origin-Resource-Policy': 'same-origin', 'Cache-Control': 'no-store'}
_PATIENCE_S = 10.0      # for a request, and for a page that takes no frames
_FAREWELL_S = 2.0       # for the last frames
_JSON = 'application/json'
_LENGTH = re.compile('[0-9]{1,9}')
_MOST_CONNECTIONS = 64


class ViewServer(ThreadingHTTPServer):
    """
    The server of the pages of a hub; ``port`` 0: any that is free.

    Raises
    ------
    ConfigError
        The port cannot be used.

    """

    daemon_threads = True
    allow_reuse_address = True
    request_queue_size = _MOST_CONNECTIONS

    def __init__(self, hub: Hub, port: int) -> None:
        try:
            super().__init__((HOST, port), _Handler)
        except (OSError, OverflowError) as error:
            reason = error.strerror if isinstance(error, OSError) else error
            raise ConfigError(f'--port {port}: cannot listen at {HOST}: {reason}') from error
        self.hub = hub
        self._room = BoundedSemaphore(_MOST_CONNECTIONS)
        self.access = Access(self.server_port)
        drawn_by = uplot()
        self.vendored = {
            'uplot.js': (f'/*! uPlot\n{drawn_by.licence}*/\n{drawn_by.script}', _SCRIPT),
            'uplot.css': (drawn_by.style, _STYLE)}

    def process_request(self, request: Any, client_address: Any) -> None:
        """Serve a connection in a thread, or end it at once if there are too many."""
        if not self._room.acquire(blocking=False):
            self.shutdown_request(request)
            return
        try:
            super().process_request(request, client_address)
        except BaseException:
            self._room.release()
            raise

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Serve a connection."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._room.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Print nothing: a browser may end its connections at any time."""


class _Handler(BaseHTTPRequestHandler):
    """One connection."""

    server: ViewServer
    protocol_version = 'HTTP/1.1'
    server_version, sys_version = 'isa_ros', ''
    timeout = _PATIENCE_S

    def do_GET(self) -> None:  # noqa: N802: name of http.server
        """Give a part of the page, or the stream of frames."""
        path = self._path(writes=False)
        if path is None:
            self._refuse()
        elif path == 'frames':
            self._stream()
        elif path == 'page.json':
            self._reply(HTTPStatus.OK, self.server.hub.page, _JSON)
        elif path in _FILES:
            file, kind = _FILES[path]
            self._reply(HTTPStatus.OK, file.read_bytes(), kind)
        elif path in self.server.vendored:
            text, kind = self.server.vendored[path]
            self._reply(HTTPStatus.OK, text.encode(), kind)
        else:
            self._reply(HTTPStatus.NOT_FOUND)

    def do_POST(self) -> None:  # noqa: N802: name of http.server
        """Take an order."""
        self.close_connection = True    # what is not read of a body is no second request
        path = self._path(writes=True)
        if path is None:
            self._refuse()
            return
        if path != 'order':
            self._reply(HTTPStatus.NOT_FOUND)
            return
        length = self.headers.get('Content-Length', '')
        if not (_LENGTH.fullmatch(length) and 0 < int(length) <= MOST_BYTES):
            self._reply(HTTPStatus.BAD_REQUEST, f'an order has 1 to {MOST_BYTES} bytes'.encode())
            return
        if self.headers.get_content_type() != _JSON:
            self._reply(HTTPStatus.BAD_REQUEST, f'an order is {_JSON}'.encode())
            return
        try:
            order = order_of(self.rfile.read(int(length)))
        except SetpointError as error:
            self._reply(HTTPStatus.BAD_REQUEST, str(error).encode())
            return
        self.server.hub.orders.put(order)
        self._reply(HTTPStatus.NO_CONTENT)

    def send_error(self, code: int, *texts: str | None) -> None:
        """Refuse another method, or what is no request."""
        self.close_connection = True
        if code != HTTPStatus.NOT_IMPLEMENTED:
            self._reply(HTTPStatus(code))
        elif self._path(writes=True) is None:
            self._refuse()
        else:
            self._reply(HTTPStatus.METHOD_NOT_ALLOWED, b'must be GET or POST')

    def log_message(self, format: str, *arguments: Any) -> None:  # noqa: A002: of http.server
        """Print nothing: the address has the token."""

    def _path(self, *, writes: bool) -> str | None:
        """Return the path behind the token; None: the request is refused."""
        return self.server.access.path_in(
            self.path, self.headers.get_all('Host', []), self.headers.get_all('Origin', []),
            writes=writes)

    def _refuse(self) -> None:
        self.close_connection = True
        self._reply(HTTPStatus.FORBIDDEN, b'open the address that isa view has printed')

    def _reply(
            self, status: HTTPStatus, body: bytes = b'', kind: str = 'text/plain') -> None:
        self.send_response(status)
        if status is not HTTPStatus.NO_CONTENT:
            self.send_header('Content-Type', f'{kind}; charset=utf-8')
            self.send_header('Content-Length', str(len(body)))
        if status is HTTPStatus.METHOD_NOT_ALLOWED:
            self.send_header('Allow', 'GET, POST')
        self._end_headers()
        if self.command != 'HEAD':
            self.wfile.write(body)

    def _end_headers(self) -> None:
        for name, value in _HEADERS.items():
            self.send_header(name, value)
        if self.close_connection:
            self.send_header('Connection', 'close')
        self.end_headers()

    def _stream(self) -> None:
        """Send frames as server-sent events, until the end or until the page is closed."""
        self.close_connection = True
        viewer = self.server.hub.opened()
        if viewer is None:
            self._reply(HTTPStatus.SERVICE_UNAVAILABLE, b'too many pages are open')
            return
        try:
            self.send_response(HTTPStatus.OK)
            self.send_header('Content-Type', 'text/event-stream; charset=utf-8')
            self._end_headers()
            while (frame := viewer.get()) is not None:
                self.wfile.write(frame)
        except OSError:
            pass    # the page was closed
        finally:
            self.server.hub.close(viewer)


@contextmanager
def serving(hub: Hub, port: int) -> Iterator[str]:
    """
    Serve the pages of a hub in threads of their own; yield the address.

    At the end every page has got its last frame, or was too slow for it. Raises as `ViewServer`.
    """
    with ViewServer(hub, port) as server:
        thread = Thread(target=server.serve_forever, kwargs={'poll_interval': 0.05}, daemon=True)
        thread.start()
        try:
            yield server.access.url
        finally:
            hub.send(None)
            hub.wait_until_left(_FAREWELL_S)
            server.shutdown()
            thread.join()
