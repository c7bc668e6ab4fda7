"""Objects of kernels: made by processes of their own, once, and whole or not at all."""

import ctypes
import math
import os
from pathlib import Path
import signal
import subprocess
import sys
import time
from typing import NamedTuple

from isa_ros.core import bitcode, compiler, kept_objects, object_making
from isa_ros.core.bound import Bound, table_of
from isa_ros.core.elf import symbols
from isa_ros.core.kernel import kernel
from isa_ros.core.objects import library_of, own_target, TARGETS
from isa_ros.errors import ConfigError, RunError
from isa_ros.export.exported import Called
from isa_ros.export.kernels import are_lowered, objects_of
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
OWN = own_target()


class Numbers(NamedTuple):
    """A memory."""

    numbers: np.ndarray


@kernel
def share(own):
    """Make numbers that do not fold; return how many."""
    for k in range(1, len(own.numbers)):
        own.numbers[k] = math.sqrt(own.numbers[k - 1]) / 3.0
    return len(own.numbers)


@kernel
def halve(own):
    """Halve the first number; return 7."""
    own.numbers[0] /= 2.0
    return 7


@kernel
def take_sine(own):
    """Call a function that no object has."""
    own.numbers[0] = math.sin(own.numbers[0])
    return 0


def given():
    """Return a memory of numbers."""
    return Numbers(np.linspace(2.0, 3.0, 5))


GROUP = (Called(share, given()),)


@pytest.fixture(autouse=True)
def directory(tmp_path, monkeypatch):
    """Return an empty directory in which objects are kept."""
    own = tmp_path / 'kept'
    monkeypatch.setattr(kept_objects, 'CACHE', own)
    monkeypatch.setattr(kept_objects, 'READ', (own,))
    return own


@pytest.fixture
def compiled(monkeypatch):
    """Return the names of the kernels that numba compiles in this process."""
    names = []
    before = compiler.dispatcher_of

    def noting(own):
        names.append(own.__name__)
        return before(own)
    monkeypatch.setattr(compiler, 'dispatcher_of', noting)
    return names


def program(monkeypatch, text):
    """Let processes that make objects run a text of Python."""
    monkeypatch.setattr(bitcode, '_PROGRAM', text)


def test_an_object_is_made_elsewhere_and_gives_the_bytes_of_this_process(tmp_path, compiled):
    code, = objects_of([GROUP], OWN)
    assert not compiled
    library_of([code], tmp_path / 'lib.so')
    called = ctypes.CDLL(str(tmp_path / 'lib.so'))['kernel_share']
    own, other = given(), given()
    assert called(ctypes.c_void_p(table_of(own).ctypes.data)) == Bound(share, other).run() == 5
    assert own.numbers.tobytes() == other.numbers.tobytes() != given().numbers.tobytes()
    assert 'entry' in compiled


def names_in(directory):
    """Return the kinds of what is kept."""
    return sorted(path.name.rpartition('-')[0] for path in directory.iterdir())


def test_it_is_made_once(directory, monkeypatch):
    """Without a process and without LLVM; damaged, it is made again."""
    assert not are_lowered([GROUP], OWN)
    first = objects_of([GROUP], OWN)
    assert are_lowered([GROUP], OWN) and names_in(directory) == ['bitcode', OWN.name]
    program(monkeypatch, 'raise SystemExit(9)')
    with monkeypatch.context() as patch:
        patch.setattr(object_making, 'object_of', None)
        assert objects_of([GROUP], OWN) == first
    path = next(directory.glob('*.o'))
    whole = path.read_bytes()
    path.write_bytes(whole[:-1])
    assert are_lowered([GROUP], OWN)
    assert objects_of([GROUP], OWN) == first and path.read_bytes() == whole
    next(directory.glob('*.bc')).write_bytes(b'damaged')
    assert objects_of([GROUP], OWN) == first and are_lowered([GROUP], OWN)
    path.unlink()
    assert not are_lowered([GROUP], OWN)
    with pytest.raises(RunError, match='exit code 9'):
        objects_of([GROUP], OWN)


def test_objects_of_all_targets_are_made_of_one_bitcode(directory, monkeypatch):
    objects_of([GROUP], OWN)
    program(monkeypatch, 'raise SystemExit(9)')
    for target in TARGETS.values():
        assert are_lowered([GROUP], target)
        code, = objects_of([GROUP], target)
        assert code[18] == (183 if target.name == 'aarch64' else 62)
        assert all(symbol.is_defined for symbol in symbols(code))
    assert names_in(directory) == sorted(['bitcode', *TARGETS])
    assert not are_lowered([GROUP, (*GROUP, Called(take_sine, given()))], OWN)


def test_each_kernel_of_an_object_is_its_own(tmp_path, compiled):
    code, = objects_of([(*GROUP, Called(halve, given()))], OWN)
    library_of([code], tmp_path / 'lib.so')
    library, own = ctypes.CDLL(str(tmp_path / 'lib.so')), given()
    table = ctypes.c_void_p(table_of(own).ctypes.data)
    assert (library.kernel_share(table), library.kernel_halve(table)) == (5, 7)
    assert own.numbers[0] == 1.0 and own.numbers[1] == math.sqrt(2.0) / 3.0 and not compiled


def test_what_an_object_cannot_have_is_refused(directory):
    with pytest.raises(ConfigError) as refused:
        objects_of([(Called(take_sine, given()),)], OWN)
    assert str(refused.value) == 'object of kernel_take_sine: undefined sin, must have none'
    assert not directory.exists()


def test_an_ended_process_is_one_line_and_leaves_nothing(directory, monkeypatch):
    """Of two, the other one is ended too."""
    program(monkeypatch, """
import os, pickle, signal, sys, time
sys.stdout.write('half')
sys.stdout.flush()
if 'share' in (own.kernel.__name__ for own in pickle.load(sys.stdin.buffer).entries):
    os.kill(os.getpid(), signal.SIGKILL)
time.sleep(600.0)
""")
    began = time.monotonic()
    with pytest.raises(RunError, match=r'^machine code: its process \d+ was ended by SIGKILL$'):
        objects_of([GROUP, (Called(take_sine, given()),)], OWN)
    assert time.monotonic() - began < 300.0
    assert not directory.exists()


def test_a_process_that_fails_says_why(directory, monkeypatch):
    program(monkeypatch, 'print("half"); raise ValueError("no way")')
    with pytest.raises(RunError, match='^machine code: its process [0-9]+ ended with exit code 1: '
                                       'ValueError: no way$'):
        objects_of([GROUP], OWN)
    monkeypatch.setattr(sys, 'executable', '/none/such')
    with pytest.raises(RunError, match='^machine code: no process can be started to make it, No '):
        objects_of([GROUP], OWN)
    assert not directory.exists()


def test_an_edit_meanwhile_is_noticed(directory, monkeypatch):
    """What the process would make is not what was asked for."""
    monkeypatch.setattr(bitcode, 'symbols_of', lambda entries: ('share_0123',))
    with pytest.raises(RunError, match='exit code 1: a source was edited meanwhile$'):
        objects_of([GROUP], OWN)
    assert not directory.exists()


def test_what_a_module_prints_is_not_taken_for_bitcode(capsys):
    from tests.export.talking import talk
    assert capsys.readouterr().out in ('', 'imported\n')
    code, = objects_of([(Called(talk, given()),)], OWN)
    assert code[:4] == b'\x7fELF'
    assert capsys.readouterr() == ('', 'imported\n')


def test_what_the_process_warns_of_is_shown(monkeypatch, capsys):
    program(monkeypatch, 'import pickle, sys; print("careful", file=sys.stderr); '
                         'pickle.dump((b"code",), sys.stdout.buffer)')
    monkeypatch.setattr(object_making, 'object_of', lambda codes, target: codes['kernel_share'])
    assert objects_of([GROUP], OWN) == (b'code',)
    assert capsys.readouterr().err == 'careful\n'


MADE = """
from isa_ros.core.objects import own_target
from isa_ros.export.kernels import objects_of
from tests.export.test_kernels import GROUP
import hashlib
print('begun', flush=True)
print(hashlib.sha256(objects_of([GROUP], own_target())[0]).hexdigest())
"""


def started(program, directory):
    """Start a program that makes objects in a cache of its own."""
    return subprocess.Popen(
        [sys.executable, '-c', program], cwd=ROOT, text=True, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, env=os.environ | {
            'NUMBA_CACHE_DIR': str(directory), 'PYTHONPATH': str(ROOT)})


def test_two_at_once_make_the_same(tmp_path):
    both = [started(MADE, tmp_path) for _ in range(2)]
    said = [own.communicate(timeout=300.0) for own in both]
    assert said[0] == said[1] and said[0][1] == '' and len(said[0][0]) > 64
    assert names_in(tmp_path / 'isa_ros' / 'kernels') == ['bitcode', OWN.name]


HELD = """
import os
from isa_ros.core.objects import own_target
from isa_ros.export.exported import Called
from isa_ros.export.kernels import objects_of
from tests.export.talking import talk
from tests.export.test_kernels import given
os.environ['HELD'] = os.environ['HELD_LATER']
objects_of([(Called(talk, given()),)], own_target())
"""


def runs(process):
    """Return whether a process has not ended; whoever has to may not have waited for it."""
    try:
        return Path('/proc', process, 'stat').read_text().rpartition(')')[2].split()[0] != 'Z'
    except FileNotFoundError:
        return False


@pytest.mark.parametrize('number', ['SIGINT', 'SIGKILL', 'SIGTERM'])
def test_an_end_of_the_export_ends_its_process(tmp_path, monkeypatch, number):
    held = tmp_path / 'held'
    monkeypatch.setenv('HELD_LATER', str(held))
    own = started('import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n'
                  + HELD, tmp_path / 'cache')
    deadline = time.monotonic() + 120.0
    while not (held.exists() and held.read_text()):
        assert time.monotonic() < deadline and own.poll() is None
        time.sleep(0.01)
    assert runs(held.read_text())
    own.send_signal(getattr(signal, number))
    own.communicate(timeout=60.0)
    while runs(held.read_text()):
        assert time.monotonic() < deadline
        time.sleep(0.01)
    assert not [path for path in (tmp_path / 'cache').rglob('*') if path.is_file()]


def test_the_process_takes_no_modules_of_the_folder_it_is_asked_in(tmp_path, monkeypatch):
    """As a checkout of another version, or a file of the user with the name of a module."""
    folder = tmp_path / 'own'
    folder.mkdir()
    (folder / 'pickle.py').write_text('raise SystemExit("of the user")')
    monkeypatch.chdir(folder)
    assert any('share' in own.name for own in symbols(objects_of([GROUP], OWN)[0]))


def test_without_the_compiler_no_process_is_started(monkeypatch):
    monkeypatch.setattr(object_making, 'IS_COMPILED', False)
    monkeypatch.setattr(subprocess, 'Popen', None)
    with pytest.raises(ConfigError, match='^NUMBA_DISABLE_JIT is set, machine code needs'):
        objects_of([GROUP], OWN)
