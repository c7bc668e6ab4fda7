"""Objects of entries: made of bitcode of which what is kept is not made again."""

from ast import literal_eval
import pickle

from isa_ros.core import bitcode, kept_objects, object_making
from isa_ros.core.kernel import entry_of
from isa_ros.core.kinds import kind_of
from isa_ros.core.object_making import objects_of_entries
from isa_ros.core.objects import own_target
from isa_ros.errors import RunError
import numpy as np
import pytest
from tests.core.test_bound import count, memory, move, Rows

OWN = own_target()
NAMES = """
import pickle, sys
names = [own.kernel.__name__ for own in pickle.load(sys.stdin.buffer).entries]
pickle.dump(tuple(b'%d %s' % (len(names), name.encode()) for name in names), sys.stdout.buffer)
"""
"""A process that gives as bitcode how many entries it was asked for, and the name of each."""


@pytest.fixture(autouse=True)
def directory(tmp_path, monkeypatch):
    """Return an empty directory for what is kept; objects are bitcode by name."""
    own = tmp_path / 'kept'
    monkeypatch.setattr(kept_objects, 'CACHE', own)
    monkeypatch.setattr(kept_objects, 'READ', (own,))
    monkeypatch.setattr(bitcode, '_PROGRAM', NAMES)
    monkeypatch.setattr(object_making, 'object_of', lambda codes, target: repr(codes).encode())
    return own


def entries(*names):
    """Return entries by exported names, which are those of their kernels."""
    own = {'move': entry_of(move, kind_of(memory())),
           'count': entry_of(count, kind_of(Rows(np.zeros(1, np.int64)))),
           'first': entry_of(move, kind_of(memory()))}
    return {name: own[name] for name in names}


def made(*groups):
    """Return the bitcode in the object of each group, by name."""
    return [literal_eval(code.decode()) for code in objects_of_entries(
        [entries(*names) for names in groups], OWN)]


def kinds_in(directory):
    """Return how many files of each kind are kept."""
    found = sorted(path.suffix for path in directory.iterdir())
    return {kind: found.count(kind) for kind in found}


def test_one_process_lowers_a_group_and_each_entry_is_kept(directory):
    assert made(('move', 'count')) == [{'move': b'2 move', 'count': b'2 count'}]
    assert kinds_in(directory) == {'.bc': 2, '.o': 1}


def test_only_what_is_not_kept_is_lowered(directory, monkeypatch):
    """Whatever its name in another object was, and in whatever order."""
    assert made(('move',)) == [{'move': b'1 move'}]
    assert made(('count', 'first')) == [{'count': b'1 count', 'first': b'1 move'}]
    monkeypatch.setattr(bitcode, '_PROGRAM', 'raise SystemExit(9)')
    assert made(('first', 'count'), ('first',)) == [
        {'first': b'1 move', 'count': b'1 count'}, {'first': b'1 move'}]
    assert kinds_in(directory) == {'.bc': 2, '.o': 4}


def test_groups_are_lowered_at_once_and_each_is_its_own(tmp_path, monkeypatch):
    """Each process waits for the other one, and has more to say than a pipe holds."""
    monkeypatch.setattr(bitcode, '_PROGRAM', f"""
import pickle, sys, time
from pathlib import Path
name, = (own.kernel.__name__ for own in pickle.load(sys.stdin.buffer).entries)
folder = Path({str(tmp_path)!r})
(folder / f'asked_{{name}}').touch()
deadline = time.monotonic() + 60.0
while len(list(folder.glob('asked_*'))) < 2:
    time.sleep(0.01)
    assert time.monotonic() < deadline
pickle.dump((b'x' * 200_000 + name.encode(),), sys.stdout.buffer)
""")
    found = made(('move',), ('count',))
    assert found == [{name: b'x' * 200_000 + name.encode()} for name in ('move', 'count')]


def test_what_is_damaged_is_lowered_again(directory, monkeypatch):
    made(('move', 'count'))
    first, _ = sorted(directory.glob('*.bc'))
    first.write_bytes(b'damaged')
    assert sorted(made(('count', 'first'))[0].values()) in (
        [b'1 count', b'2 move'], [b'1 move', b'2 count'])


@pytest.mark.parametrize('told', [b'', pickle.dumps((b'code',) * 3)[:-2], b'no bitcode'])
def test_an_answer_that_is_not_whole_is_one_line(directory, monkeypatch, told):
    monkeypatch.setattr(bitcode, '_PROGRAM', f'import sys; sys.stdout.buffer.write({told!r})')
    with pytest.raises(RunError, match='^machine code: [^\n]+$'):
        made(('move',))
    assert not directory.exists()


def test_too_few_answers_make_no_object(directory, monkeypatch):
    monkeypatch.setattr(bitcode, '_PROGRAM', 'import pickle, sys\n'
                        'pickle.dump((b"one",), sys.stdout.buffer)')
    with pytest.raises(ValueError, match='shorter'):
        made(('move', 'count'))
    assert not directory.exists()
