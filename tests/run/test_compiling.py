"""The report of a compilation: one line where it takes long, none from the cache."""

import io

from isa_ros.run.compiling import reported_compilation, SILENT_S
import numba
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
    assert text.count('isa: compiling the simulation, once') == text.count('\n') == 1
    if stream is Terminal:
        assert '0 kernels compiled, 2 s: inner' in text and text.endswith('\r\033[K')
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
