"""How workers find their tests."""

import sys
from types import SimpleNamespace

import pytest
from tests.scheduling import import_share

FILES = {'test_a.py': 'A = 1', 'test_b.py': '1 / 0', 'inner/test_c.py': 'C = 1',
         'test_d.py': 'import pytest; pytest.importorskip("none_such")', 'other.py': '',
         'test_e.py': 'E = 1', 'test_f.py': 'import pytest; pytest.fail("all of it")'}


@pytest.mark.parametrize('worker, imported', [
    ('gw0', {'inner.test_c'}), ('gw1', {'test_a', 'test_e'}), ('gw2', set())])
def test_each_of_three_imports_a_third(worker, imported, tmp_path, monkeypatch):
    """What cannot be imported is left to the collection."""
    folder = tmp_path / f'sample_{worker}'
    for name, text in FILES.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    before = set(sys.modules)
    try:
        import_share(SimpleNamespace(workerinput={'workerid': worker, 'workercount': 3}), folder)
    except BaseException as error:  # a skipped or failed module would be that of this test
        raise AssertionError('not left to the collection') from error
    found = {name for name in set(sys.modules) - before if '.test_' in name}
    assert found == {f'{folder.name}.{name}' for name in imported}
