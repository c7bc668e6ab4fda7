"""Report the compilation of kernels, which takes minutes after an installation or an edit."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, ExitStack
import sys
from threading import Lock
import time
from typing import Any, TextIO

from isa_ros.core.compilations import compilations
from isa_ros.core.kernel_directory import is_kept
from isa_ros.core.kernel_key import kernels_of
from isa_ros.core.value_text import UnknownValue
from isa_ros.text.progress import repeated, terminal_line

SILENT_S = 2.0  # a shorter compilation, of single small kernels, is not reported


class CompilationReport:
    """
    Prints one line when kernels have been compiled for `SILENT_S`; counts them on a terminal.

    Kernels are compiled when the kernel that calls them is, so that reports follow each other.
    They are counted among those of a tick, where that is loaded, and of the outermost one; what
    the next outermost one needs is counted when it begins. A large kernel takes many seconds, so
    the line is shown anew by `refresh` too.
    """

    def __init__(self, who: str, stream: TextIO, clock: Callable[[], float]) -> None:
        self._who, self._stream, self._clock = who, stream, clock
        self._line = terminal_line(stream)
        self._began: float | None = None
        self._is_announced = False
        self._outermost: Any = None
        self._total: int | None = None
        self._running: list[str] = []
        self._finished = 0
        self._lock = Lock()

    def start(self, kernel: Any) -> None:
        """Announce the compilation if it has lasted; show what is compiled next."""
        with self._lock:
            now = self._clock()
            if self._began is None:
                self._began = now
            if not self._running:
                self._outermost = kernel
            self._running.append(kernel.__name__)
            if now - self._began >= SILENT_S:
                self._count()
                self._show(now)

    def _count(self) -> None:
        """Announce how many kernels are to be compiled, once; count them where there are more."""
        if self._total is None or self._finished >= self._total:
            self._total = self._finished + to_compile(self._outermost, *_of_tick())
        if not self._is_announced:
            self._is_announced = True
            self._stream.write(
                f'{self._who}: compiling the simulation, {self._total} kernels, once after an '
                'installation or an edit\n')
            self._stream.flush()

    def _show(self, now: float) -> None:
        if self._line is not None and self._total is not None and self._running:
            self._line.show(
                f'compiling kernels, {self._finished} of {self._total}, '
                f'{now - (self._began or 0.0):.0f} s: {self._running[-1]}')

    def refresh(self) -> None:
        """Show the time anew, while something is compiled."""
        with self._lock:
            self._show(self._clock())

    def end(self) -> None:
        """Count a kernel; clear the terminal's line when the outermost one is finished."""
        with self._lock:
            if not self._running:
                return      # it began before this report
            self._running.pop()
            self._finished += 1
            if self._line is not None and self._is_announced and not self._running:
                self._line.erase()


def _of_tick() -> Sequence[Any]:
    """Return the kernel of a tick, which needs nearly all, if it is loaded and not kept."""
    module = sys.modules.get('isa_ros.actuator.ticking')
    if module is None:
        return []
    tick = module.tick_kernel()
    return [] if tick.compiled.overloads or tick.is_kept() else [tick.compiled]


def to_compile(*kernels: Any) -> int:
    """Return how many of kernels and those they call are neither loaded nor kept; at least 1."""
    try:
        missing = [own for own in kernels_of(*kernels)
                   if not own.overloads and not is_kept(own)]
    except UnknownValue:
        return 1
    return max(len(missing), 1)


@contextmanager
def reported_compilation(
        who: str, stream: TextIO | None = None,
        clock: Callable[[], float] = time.monotonic) -> Iterator[None]:
    """Report compilations within the context on ``stream``, None: standard error."""
    stream = stream or sys.stderr
    report = CompilationReport(who, stream, clock)
    with ExitStack() as stack:
        def watch() -> None:
            stack.enter_context(_reported_to(report))
            stack.enter_context(compilations().watched_by(report))
            if stream.isatty():
                stack.enter_context(repeated(report.refresh))
        if 'numba' in sys.modules:
            watch()
        else:       # not before a kernel is compiled: loading it takes longer than a start
            stack.enter_context(compilations().awaited_by(watch))
        yield


def _reported_to(report: CompilationReport) -> AbstractContextManager[object]:
    """Return a context in which the compiler tells a report what it does."""
    from numba.core.event import Event, install_listener, Listener

    class Reported(Listener):
        def on_start(self, event: Event) -> None:
            report.start(event.data['dispatcher'])

        def on_end(self, event: Event) -> None:
            report.end()
    context: AbstractContextManager[object] = install_listener('numba:compile', Reported())
    return context
