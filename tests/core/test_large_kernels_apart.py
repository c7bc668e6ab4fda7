"""Large kernels beside others: another process, a copy of this one, numba, missing sources."""

import math
import os
import sys
import threading
import time

from isa_ros.core import bitcode, kept_objects, kernel as kernels, kernel_library
from isa_ros.core import large_kernels, object_making
from isa_ros.core.kernel import kernel
from isa_ros.core.kernel_key import UnknownValue
from isa_ros.core.large_kernels import is_large, is_made, made
from isa_ros.errors import ConfigError
import pytest
from tests.core.test_large_kernels import entry, third
from tests.threads import forget_number

pytestmark = pytest.mark.usefixtures('directory')


@kernel
def thirds_of_two(x, y):
    return third(x), third(y)


@kernel
def cosine_of_a_third(x):
    """Call a function that no object has."""
    return math.cos(third(x))


def test_the_process_begins_no_other(monkeypatch):
    """What its modules run as they are imported is numba's."""
    monkeypatch.setattr(bitcode, '_PROGRAM', """
import pickle
from isa_ros.core import large_kernels, lowering_process
load = pickle.load


def loading(file):
    assert large_kernels.PACKAGES == []
    return load(file)


assert large_kernels.PACKAGES == ['isa_ros']
pickle.load = loading
sys.exit(lowering_process.main())
""")
    assert made(entry()) is not None


def test_ctrl_c_is_not_for_it(monkeypatch):
    """A terminal sends it to all processes of a session's group in the foreground."""
    monkeypatch.setattr(bitcode, '_PROGRAM', """
import os
assert os.getsid(0) == os.getpgrp() == os.getpid()
""" + bitcode._PROGRAM)
    assert made(entry()) is not None


def test_its_libraries_begin_no_threads(monkeypatch):
    forget_number(monkeypatch)
    monkeypatch.setattr(bitcode, '_PROGRAM', """
import os, numpy
assert len(os.listdir('/proc/self/task')) == 1 and os.environ['HELD'] == 'here'
""" + bitcode._PROGRAM)
    monkeypatch.setenv('HELD', 'here')
    assert made(entry()) is not None
    assert 'OPENBLAS_NUM_THREADS' not in os.environ


def test_what_it_says_is_lost_where_nothing_can_be_written(monkeypatch):
    class Closed:
        """Standard error after its end."""

        said = []

        def write(self, text):
            """Refuse a text."""
            self.said.append(text)
            raise ValueError('I/O operation on closed file')

    monkeypatch.setattr(
        bitcode, '_PROGRAM', 'print("beside", file=sys.stderr)\n' + bitcode._PROGRAM)
    monkeypatch.setattr(sys, 'stderr', Closed())
    assert made(entry()) is not None
    assert Closed.said == ['beside\n']


def test_a_copy_of_the_process_waits_for_no_thread(monkeypatch):
    """Which makes a kernel while the copy is made, and is not copied."""
    begun, goes_on = threading.Event(), threading.Event()
    before = object_making.objects_of_entries

    def slow(*given):
        begun.set()
        assert goes_on.wait(60.0)
        return before(*given)
    monkeypatch.setattr(object_making, 'objects_of_entries', slow)
    thread = threading.Thread(target=made, args=[entry()])
    thread.start()
    assert begun.wait(60.0)
    process = os.fork()
    if process == 0:
        monkeypatch.setattr(large_kernels, '_made', lambda entry: None)
        os._exit(3 if made(entry()) is None else 4)
    deadline, ended = time.monotonic() + 20.0, (0, 0)
    while ended == (0, 0) and time.monotonic() < deadline:
        ended = os.waitpid(process, os.WNOHANG)
        time.sleep(0.01)
    if ended == (0, 0):
        os.kill(process, 9)
        os.waitpid(process, 0)
    goes_on.set()
    thread.join()
    assert os.waitstatus_to_exitcode(ended[1]) == 3 and ended[0] == process


def refuse(*given):
    """Begin nothing."""
    raise AssertionError('a process is begun')


def test_a_called_one_that_numba_keeps_begins_no_process(monkeypatch):
    """By its kernel, which has no entry around it; a bound one is kept by its entry."""
    monkeypatch.setattr(object_making, 'objects_of_entries', refuse)
    asked = []
    monkeypatch.setattr(large_kernels, 'is_kept', lambda own: asked.append(own) or True)
    assert cosine_of_a_third(1.3) == math.cos(1.3 / 3.0)
    assert made(entry()) is None
    assert asked == [cosine_of_a_third.compiled, entry().compiled]


def test_arguments_by_name_are_numbas(monkeypatch):
    monkeypatch.setattr(object_making, 'objects_of_entries', refuse)
    assert thirds_of_two(y=2.0, x=1.0) == (1.0 / 3.0, 2.0 / 3.0)


def test_without_sources_it_is_numbas(monkeypatch):
    """As where only bytecode is installed."""
    def missing(path):
        raise UnknownValue(f'source {path}')
    assert is_large(entry())
    with monkeypatch.context() as patch:
        patch.setattr(kernel_library, 'file_digest', missing)
        kernel_library._makers.cache_clear()
        assert not is_large(entry()) and not is_made(entry()) and made(entry()) is None
        patch.setattr(kernels, 'is_kept', lambda kernel: False)
        assert not entry().is_kept()


def test_an_object_that_is_kept_comes_before_numba(monkeypatch):
    """And needs no process."""
    assert made(entry()) is not None
    large_kernels._made.cache_clear()
    monkeypatch.setattr(large_kernels, 'is_kept', lambda own: True)
    monkeypatch.setattr(bitcode, '_PROGRAM', 'raise SystemExit(9)')
    assert made(entry()) is not None


def test_a_processor_without_objects_is_numbas(monkeypatch):
    def unknown():
        raise ConfigError('processor riscv64: none of the targets')
    monkeypatch.setattr('isa_ros.core.objects.own_target', unknown)
    assert is_large(entry()) and not is_made(entry()) and made(entry()) is None


def test_other_words_in_a_source_leave_what_is_kept(monkeypatch):
    def refused(kernel):
        raise AssertionError('the text of a source is read')
    monkeypatch.setattr(kernel_library, 'source_digest', refused)
    symbol, = kernels.symbols_of((entry(),))
    assert symbol == entry().kept_symbol and symbol.startswith('bound_thirds_')


def test_it_runs_where_the_folder_of_this_one_is_gone(monkeypatch, tmp_path):
    """And takes modules from the places that this one means, also by names that are not whole."""
    monkeypatch.chdir(tmp_path.parent)
    monkeypatch.setattr(sys, 'path', [tmp_path.name, '', *filter(None, sys.path)])
    monkeypatch.setattr(bitcode, '_PROGRAM', f"""
assert {str(tmp_path)!r} in sys.path and sys.flags.isolated
assert '' not in sys.path and {str(tmp_path.parent)!r} not in sys.path
""" + bitcode._PROGRAM)
    assert made(entry()) is not None
    gone = tmp_path / 'gone'
    gone.mkdir()
    monkeypatch.setattr(sys, 'path', ['', *map(os.path.abspath, filter(None, sys.path))])
    monkeypatch.chdir(gone)
    gone.rmdir()
    for path in kept_objects.CACHE.iterdir():
        path.unlink()
    large_kernels._made.cache_clear()
    assert made(entry()) is not None
