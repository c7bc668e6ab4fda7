"""The report of a compilation: one line where it takes long, none from the cache."""

import io

from isa_ros.actuator.ticking import tick_kernel
from isa_ros.config.assembly import group_of
from isa_ros.core.compilations import compilations
from isa_ros.core.kernel import KernelEntry
from isa_ros.core.kernel_directory import is_kept
from isa_ros.core.kernel_key import kernels_of
from isa_ros.core.signals import LOAD_PORT
from isa_ros.run import compiling
from isa_ros.run.compiling import reported_compilation, SILENT_S, to_compile
from isa_ros.scripting.run import load
import numba
import numpy as np
import pytest


class Terminal(io.StringIO):
    """A terminal that keeps what is written."""

    def isatty(self) -> bool:
        return True


class Clock:
    """Advances by a step at each call."""

    def __init__(self, step_s: float) -> None:
        self._now, self._step_s = 0.0, step_s

    def __call__(self) -> float:
        self._now += self._step_s
        return self._now


@pytest.fixture(autouse=True)
def _is_kept(monkeypatch):
    """Assume that the tick is kept, as where the suite has run before."""
    monkeypatch.setattr(compiling, '_of_tick', lambda: [])


def kernels():
    """Return a new kernel that calls another one."""
    @numba.njit
    def inner(x):
        return 2.0 * x

    @numba.njit
    def outer(x):
        return inner(x) + 1.0
    return outer


@pytest.mark.parametrize('stream', [io.StringIO, Terminal])
def test_a_long_compilation_is_announced_once(stream):
    said, outer = stream(), kernels()
    with reported_compilation('isa', said, Clock(SILENT_S)):
        assert outer(1.0) == 3.0
        assert kernels()(2.0) == 5.0
    text = said.getvalue()
    assert text.count('isa: compiling the simulation, 2 kernels, once') == text.count('\n') == 1
    if stream is Terminal:
        assert 'compiling kernels, 0 of 2, 2 s: inner' in text and text.endswith('\r\033[K')
    else:
        assert '\r' not in text


def test_a_short_one_and_one_before_are_not():
    said, outer = io.StringIO(), kernels()
    with reported_compilation('isa', said, Clock(0.1 * SILENT_S)):
        outer(1.0)
    with reported_compilation('isa', said, Clock(SILENT_S)):
        outer(1.0)  # compiled already
    assert said.getvalue() == ''


def test_outside_the_context_nothing_is_reported():
    said = io.StringIO()
    with reported_compilation('isa', said, Clock(SILENT_S)):
        pass
    kernels()(1.0)
    assert said.getvalue() == ''


def test_the_total_is_of_what_is_not_compiled_yet():
    """A kernel that two call is one; those before are counted with what is finished."""
    @numba.njit
    def shared(x):
        return x + 1.0

    @numba.njit
    def left(x):
        return shared(x)

    @numba.njit
    def right(x):
        return shared(x) + left(x)
    assert to_compile(right) == 3 and to_compile(shared) == 1
    said = Terminal()
    with reported_compilation('isa', said, Clock(SILENT_S)):
        left(1.0)
        assert to_compile(right) == 1
        right(1.0)
    text = said.getvalue()
    assert '2 of 3, ' in text and text.count('compiling the simulation, 2 kernels') == 1


def test_kernels_that_are_kept_are_not_counted():
    """The tick of the actuators has been compiled by other tests, or is now."""
    group_of(load('rig_linear').configuration).advance(np.zeros(1, LOAD_PORT))
    tick = tick_kernel().compiled
    kept = [own for own in kernels_of(tick) if is_kept(own)]
    assert len(kernels_of(tick)) > 50
    assert to_compile(tick) <= max(1, len(kernels_of(tick)) - len(kept))


def test_a_tick_that_is_neither_loaded_nor_kept_is_in_the_total(monkeypatch):
    """So that the first of many small kernels already knows of nearly all."""
    monkeypatch.undo()
    assert compiling._of_tick() == []       # another test has compiled it
    monkeypatch.setattr(compiling, 'is_kept', lambda kernel: False)
    monkeypatch.setattr(KernelEntry, 'is_kept', lambda entry: False)
    tick = tick_kernel().compiled
    before = [own for own in kernels_of(tick) if not own.overloads]
    assert compiling._of_tick() == ([] if tick.overloads else [tick])
    said = io.StringIO()
    monkeypatch.setattr(compiling, '_of_tick', lambda: [tick])
    with reported_compilation('isa', said, Clock(SILENT_S)):
        kernels()(1.0)
    assert f'the simulation, {len(before) + 2} kernels, once' in said.getvalue()


def test_the_total_grows_when_the_next_kernel_begins_and_not_by_one_each_time():
    """After the first two, two more are known at once: 2 of 4, never 2 of 3."""
    said, first = Terminal(), kernels()
    with reported_compilation('isa', said, Clock(SILENT_S)):
        first(1.0)
        kernels()(2.0)
    shown = [own.partition(' s: ')[0] for own in said.getvalue().split('compiling kernels, ')[1:]]
    assert [*dict.fromkeys(own.partition(', ')[0] for own in shown)] == ['0 of 2', '2 of 4']


def test_a_large_kernel_is_shown_with_the_time_it_takes():
    """As often as `refresh` is called; nothing before it has lasted, or once it has ended."""
    said, clock = Terminal(), Clock(SILENT_S)
    report = compiling.CompilationReport('isa', said, clock)
    outer = kernels()
    report.refresh()
    assert said.getvalue() == ''
    report.start(outer)
    report.start(outer)
    before = said.getvalue()
    report.refresh()
    report.refresh()
    more = said.getvalue().removeprefix(before).split('\r')[1:]
    assert [own.partition(': ')[0] for own in more] == [
        'compiling kernels, 0 of 2, 4 s', 'compiling kernels, 0 of 2, 6 s']
    report.end()
    report.end()
    erased = said.getvalue()
    report.refresh()
    assert said.getvalue() == erased and erased.endswith('\r\033[K')


def test_the_end_of_what_began_before_the_report_is_not_counted():
    """As where a thread reports while another one's process makes a kernel."""
    said = Terminal()
    with reported_compilation('isa', said, Clock(SILENT_S)):
        compilations().end()
        assert said.getvalue() == ''
        for inner in (1, 2):
            compilations().start(kernels())
            compilations().end()
    assert 'isa: compiling the simulation, 3 kernels' in said.getvalue()
