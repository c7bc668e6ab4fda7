"""Kept objects: found again by all that they depend on, and by nothing less."""

from isa_ros.core import kept_objects
from isa_ros.core.kept_objects import bitcode_name, keep, kept, object_name
from isa_ros.core.kernel import entry_of, kernel, symbols_of
from isa_ros.core.kernel_cache import say_not_kept
from isa_ros.core.kinds import kind_of
from isa_ros.core.objects import TARGETS
from isa_ros.core.value_text import UnknownValue
import numpy as np
import pytest
from tests.core.test_bound import count, memory, move, Rows

V3, V1 = TARGETS['x86-64-v3'], TARGETS['x86-64']


@pytest.fixture(autouse=True)
def directory(tmp_path, monkeypatch):
    """Return an empty directory in which objects are kept."""
    own = tmp_path / 'kernels'
    monkeypatch.setattr(kept_objects, 'CACHE', own)
    monkeypatch.setattr(kept_objects, 'READ', (tmp_path / 'of_all', own))
    say_not_kept.cache_clear()
    return own


def entries():
    """Return two entries by name."""
    return {'moved': entry_of(move, kind_of(memory())),
            'counted': entry_of(count, kind_of(Rows(np.zeros(1, np.int64))))}


def test_what_is_kept_is_found_in_each_directory(directory, tmp_path):
    name = object_name(entries(), V3)
    assert kept(name) is None
    keep(name, b'code')
    assert kept(object_name(entries(), V3)) == b'code'
    assert [path.name for path in directory.iterdir()] == [name]
    directory.rename(tmp_path / 'of_all')
    assert kept(name) == b'code'
    (tmp_path / 'of_all' / name).write_bytes(b'damaged')
    assert kept(name) is None


@kernel
def other(own):
    """Do something else with the same kind of memory."""
    own.numbers[0] -= 1
    return 0


def test_what_an_object_depends_on_is_in_its_name(monkeypatch):
    own = entries()
    count_kind = own['counted'].kind
    others = (entry_of(other, count_kind), entry_of(count, kind_of(Rows(np.zeros(1)))))
    names = [object_name(*given) for given in (
        (own, V3), (own, V1), (own, V3._replace(cpu='znver4')),
        ({'moved': own['moved']}, V3), ({'tick': own['moved'], 'counted': own['counted']}, V3),
        *((own | {'counted': entry}, V3) for entry in others))]
    names += map(bitcode_name, (*own.values(), *others))
    context = kept_objects.cpu_target.target_context

    class Codegen:
        def magic_tuple(self):
            return 'x86_64', 'another', ''
    with monkeypatch.context() as patch:
        patch.setattr(context, 'codegen', Codegen)
        names += [object_name(own, V3), bitcode_name(own['moved'])]
    monkeypatch.setattr(kept_objects, 'environment', lambda: 'numba 99')
    names += [object_name(own, V3), bitcode_name(own['moved'])]
    assert len(set(names)) == len(names) == 15
    kinds = [name.rpartition('-')[0] for name in names]
    assert kinds[:2] == ['x86-64-v3', 'x86-64'] and kinds[7:11] == ['bitcode'] * 4


def test_what_has_no_name_is_not_kept(directory, monkeypatch, capsys):
    def refuse(*given):
        raise UnknownValue('source a.py')
    from isa_ros.core import kernel as kernels
    monkeypatch.setattr(kernels, 'kept_symbol_of', refuse)
    assert symbols_of(entries().values()) is None and object_name(entries(), V3) is None
    assert bitcode_name(entries()['moved']) is None
    keep(None, b'code')
    assert kept(None) is None and not directory.exists()
    line, = capsys.readouterr().err.splitlines()
    assert line.startswith('isa_ros: compiled kernels cannot be kept, as a source is missing: ')


def test_what_cannot_be_kept_is_one_line(directory, monkeypatch, capsys):
    directory.write_text('a file')
    keep('a.o', b'code')
    assert 'cannot be kept, File exists: every' in capsys.readouterr().err
    monkeypatch.setattr(kept_objects, 'CACHE', None)
    keep('a.o', b'code')
    line, = capsys.readouterr().err.splitlines()
    assert 'cannot be kept, no directory is writable: ' in line
