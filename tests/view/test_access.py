"""Who gets a path: the right token, the server's own name, the page's own origin."""

from isa_ros.view.access import Access
import pytest

OWN = Access(4711)
HOST = ['127.0.0.1:4711']
ORIGIN = ['http://127.0.0.1:4711']


def path_in(path=f'/{OWN.token}/frames', hosts=HOST, origins=ORIGIN, writes=True):
    return OWN.path_in(path, hosts, origins, writes=writes)


def test_the_page_itself_gets_its_path():
    """By both names of the server, and without an origin where it only reads."""
    assert path_in() == 'frames'
    assert path_in(f'/{OWN.token}/') == ''
    assert path_in(hosts=['localhost:4711'], origins=['http://localhost:4711']) == 'frames'
    assert path_in(origins=[], writes=False) == 'frames'
    assert OWN.url == f'http://127.0.0.1:4711/{OWN.token}/'


@pytest.mark.parametrize('changed', [
    {'path': '/'}, {'path': '/frames'}, {'path': f'/{OWN.token}'}, {'path': '//frames'},
    {'path': f'/{OWN.token[:-1]}/frames'}, {'path': f'/{OWN.token}\xe9/frames'},
    {'path': f'http://127.0.0.1:4711/{OWN.token}/frames'},
    {'hosts': []}, {'hosts': HOST * 2}, {'hosts': ['127.0.0.1']}, {'hosts': ['evil.org:4711']},
    {'hosts': ['0.0.0.0:4711']},
    {'hosts': ['127.0.0.1:4712']}, {'hosts': ['127.0.0.1.evil.org:4711']},
    {'origins': []}, {'origins': ORIGIN * 2}, {'origins': ['http://evil.org']},
    {'origins': ['null']}, {'origins': ['https://127.0.0.1:4711']},
    {'origins': ['http://127.0.0.1:4712']}, {'origins': ['http://evil.org'], 'writes': False},
    {'hosts': ['evil.org:4711'], 'writes': False}, {'path': '/x/frames', 'writes': False}])
def test_others_get_none(changed):
    """Without token, by another name (DNS rebinding), from another page, or twice."""
    assert path_in(**changed) is None


def test_every_server_has_a_token_of_its_own():
    """Of 24 random bytes."""
    tokens = {Access(1).token for _ in range(20)}
    assert len(tokens) == 20 and {len(token) for token in tokens} == {32}
