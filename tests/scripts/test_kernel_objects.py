"""Objects that scripts make of kernels: of bitcode that is kept, or refused with a reason."""

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from isa_ros.core import kept_objects
from isa_ros.core.kept_objects import bitcode_name
from isa_ros.core.kernel import entry_of, kernel
from isa_ros.core.kernel_cache import say_not_kept
from isa_ros.core.kinds import kind_of
from isa_ros.core.lowering import lower_long
from isa_ros.core.objects import TARGETS
from isa_ros.errors import ConfigError
import numpy as np
import pytest
from scripts import kernel_objects
from scripts.kernel_objects import Objects
from tests.core.test_bound import memory, move, Rows

FACTOR = 3.0
OLD, NEW = TARGETS['x86-64'], TARGETS['x86-64-v3']


@kernel
def scale(own):
    """Multiply a number by that of the module."""
    own.numbers[0] *= FACTOR
    return 0


def entry():
    """Return an entry of a kernel."""
    return entry_of(move, kind_of(memory()))


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    """Return an empty directory in which bitcode is kept, also by other processes."""
    own = tmp_path / 'isa_ros' / 'kernels'
    monkeypatch.setenv('NUMBA_CACHE_DIR', str(tmp_path))
    monkeypatch.setattr(kept_objects, 'CACHE', own)
    monkeypatch.setattr(kept_objects, 'READ', (own,))
    monkeypatch.setattr(kernel_objects, 'own_target', lambda: NEW)
    say_not_kept.cache_clear()
    return own


def objects_in(folder, *targets):
    """Return objects in a new folder, which are made for this processor too."""
    folder.mkdir()
    return Objects(folder, tuple(target.name for target in targets))


def test_bitcode_is_kept_and_gives_the_same_objects(tmp_path, place, monkeypatch, capsys):
    """It is made by a process that runs no kernel; this one would make other code."""
    first, second = (objects_in(tmp_path / name, OLD) for name in 'ab')
    with ProcessPoolExecutor(1, get_context('spawn'), initializer=lower_long) as process:
        assert process.submit(first.make, entry()).result() == {}
    assert [path.name for path in place.iterdir()] == [bitcode_name(entry())]
    monkeypatch.setattr(kernel_objects, 'bitcode_of', None)
    monkeypatch.setattr(kept_objects, 'CACHE', None)
    assert second.make(entry()) == {} and capsys.readouterr() == ('', '')
    symbol = entry().symbol
    codes = [first.path(symbol, target.name).read_bytes() for target in (OLD, NEW)]
    assert codes == [second.path(symbol, target.name).read_bytes() for target in (OLD, NEW)]
    assert codes[0] != codes[1]


def test_what_is_made_is_not_made_again(tmp_path, place, monkeypatch):
    objects = objects_in(tmp_path / 'a', OLD)
    assert objects.make(entry()) == {}
    symbol = entry().symbol
    objects.path(symbol, OLD.name).unlink()
    made, object_of = [], kernel_objects.object_of
    monkeypatch.setattr(kernel_objects, 'object_of', lambda codes, target: (
        made.append((*codes, target)), object_of(codes, target))[1])
    assert objects.make(entry()) == {} == objects.make(entry())
    assert made == [(symbol, OLD)]


def test_bitcode_of_a_value_that_has_changed_is_not_kept(tmp_path, place, monkeypatch):
    """Its name would be that of the value at first sight."""
    own = entry_of(scale, kind_of(Rows(np.ones(1))))
    assert bitcode_name(own) is not None
    monkeypatch.setattr(f'{__name__}.FACTOR', 7.0)
    assert objects_in(tmp_path / 'a').make(own) == {} and not place.exists()


def test_where_nothing_can_be_kept_objects_are_made_without_a_word(tmp_path, place, capsys):
    place.parent.write_text('a file')
    objects = objects_in(tmp_path / 'a')
    assert objects.make(entry()) == {} and len(list(objects.directory.iterdir())) == 1
    assert capsys.readouterr() == ('', '')


def refuse(codes, target):
    """Make the object of no target but x86-64."""
    if target != OLD:
        raise ConfigError('object of merge_0: undefined sin, must have none')
    return b'code'


def test_a_target_that_cannot_have_an_entry_says_why(tmp_path, place, monkeypatch):
    """And what it was made of is not kept."""
    monkeypatch.setattr(kernel_objects, 'object_of', refuse)
    objects = objects_in(tmp_path / 'a', OLD)
    assert objects.make(entry()) == {'x86-64-v3': 'undefined sin, must have none'}
    assert [path.read_bytes() for path in objects.directory.iterdir()] == [b'code']
    assert not place.exists()


def test_what_cannot_be_called_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr(kernel_objects, 'object_of', refuse)
    with pytest.raises(ConfigError, match='^kernel move: undefined sin, must have none$'):
        objects_in(tmp_path / 'a').address(entry())
