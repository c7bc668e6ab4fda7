"""
Make the libraries of kernels in isa_ros/kernels, by all cores: starts then take no compiler.

    python -m scripts.make_kernels                  for the processor of this machine
    python -m scripts.make_kernels --own            for older ones of its kind too
    python -m scripts.make_kernels --all            for all targets, as the wheel has them
    python -m scripts.make_kernels x86-64 aarch64   for these

A library of another architecture is linked by `aarch64-linux-gnu-ld` (in the package
binutils-aarch64-linux-gnu); without it it is left out, and a line says so. What a library does
not have is compiled at its first use.
"""

from argparse import ArgumentParser
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
import multiprocessing
import os
from pathlib import Path
import shutil
import signal
import sys
from tempfile import TemporaryDirectory
import time
from typing import Any, NamedTuple, TextIO

from isa_ros.core.kernel_library import own_targets, SHIPPED
from isa_ros.core.lowering import declare, lower_long
from isa_ros.core.objects import library_of, own_target, Target, TARGETS
from isa_ros.text.progress import terminal_line
from scripts.kernel_objects import Objects
from scripts.kernel_rehearsal import ALONE, rehearsals, rehearse, tick, WantedKernel

PERIOD_S = 1.5          # between two lines
_REHEARSAL = 30         # size of one, in kernels
_KNOWN = 0.4            # share done from which on sizes foretell the time: the first are slow


class Job(NamedTuple):
    """Work of one process: a rehearsal, or the objects of an entry."""

    size: int
    work: Callable[..., Any]
    arguments: tuple[Any, ...]
    name: str


def make(wanted: WantedKernel, objects: Objects) -> dict[str, str]:
    """Make the objects of an entry; return why a target has none."""
    return objects.make(wanted.entry)


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """
    Let processes that are started within never see Ctrl-C: it is for the one that starts them.

    One that comes meanwhile is blocked and not ignored, in which case it would be lost.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _ended() -> Iterator[None]:
    """End the processes at Ctrl-C, and do not wait for what they make."""
    try:
        yield
    except KeyboardInterrupt:
        for process in multiprocessing.active_children():
            process.kill()
        raise


class KernelProgress:
    """Prints how many kernels are made and the time left by sizes; on a terminal one line."""

    def __init__(self, stream: TextIO, clock: Callable[[], float] = time.monotonic) -> None:
        self._stream, self._clock = stream, clock
        self._line = terminal_line(stream)
        self._began = self._shown = clock()
        self.made = self.total = 0
        """Entries."""
        self.done = self.left = 0
        """Sizes of all jobs."""

    def show(self, running: Sequence[str], *, is_last: bool = False) -> None:
        """Print a line, if the last one is some time ago."""
        now = self._clock()
        if not is_last and now - self._shown < PERIOD_S:
            return
        self._shown = now
        spent = now - self._began
        known = self.done >= _KNOWN * (self.done + self.left) > 0
        rest = f'{spent * self.left / self.done:.0f} s left' if known else 'beginning'
        text = (f'kernels: {self.made} of {self.total}, {spent:.0f} s, '
                + ('finished' if is_last else f'{rest}: {", ".join(running)}'))
        if self._line is None:
            print(text, file=self._stream, flush=True)
        elif is_last:
            self._line.end(text)
        else:
            self._line.show(text)


class Making:
    """The jobs of all processes, the largest first."""

    def __init__(self, objects: Objects, progress: KernelProgress) -> None:
        self._objects, self._progress = objects, progress
        self._waiting: list[Job] = []
        self._running: dict[Future[Any], Job] = {}
        self.refused: dict[str, dict[str, str]] = {}
        """By symbol, why a target does not have it."""
        self._want(tick())  # the largest, of all runs
        for name in rehearsals():
            self._add(Job(_REHEARSAL, rehearse, (name, objects), f'kernels of {name}'))

    def _add(self, job: Job) -> None:
        self._waiting.append(job)
        self._waiting.sort(key=lambda own: (own.size, own.name == f'kernels of {ALONE}'))
        self._progress.left += job.size

    def run(self, processes: int) -> None:
        """Do all jobs; what has been imported and declared here need not be by each process."""
        declare()
        context = multiprocessing.get_context('fork')
        with ProcessPoolExecutor(processes, context, initializer=lower_long) as pool, _ended():
            while self._waiting or self._running:
                while self._waiting and len(self._running) < processes:
                    job = self._waiting.pop()
                    with _without_interrupts():
                        self._running[pool.submit(job.work, *job.arguments)] = job
                for future in wait(self._running, PERIOD_S, 'FIRST_COMPLETED').done:
                    self._take(self._running.pop(future), future.result())
                self._progress.show([job.name for job in self._running.values()])
        self._progress.show([], is_last=True)

    def _take(self, job: Job, result: Any) -> None:
        progress = self._progress
        progress.done, progress.left = progress.done + job.size, progress.left - job.size
        if job.work is make:
            self.refused[job.arguments[0].symbol] = result
            progress.made += 1
            return
        for wanted in result:
            self._want(wanted)

    def _want(self, wanted: WantedKernel) -> None:
        if wanted.symbol not in self.refused:
            self.refused[wanted.symbol] = {}
            self._progress.total += 1
            self._add(Job(wanted.size, make, (wanted, self._objects), wanted.name))


def link(target: Target, symbols: Iterable[str], objects: Objects, out: Path) -> str:
    """Write the library of a target; return a line about it."""
    is_own = target.triple == own_target().triple
    linker = 'cc' if is_own else f'{target.triple.replace("unknown-", "")}-ld'
    if shutil.which(linker) is None:
        return f'{target.name}: left out, there is no {linker} to link it with'
    paths = [objects.path(symbol, target.name) for symbol in symbols]
    codes = [path.read_bytes() for path in paths if path.exists()]
    aside = out / f'.{target.name}.part'
    library_of(codes, aside, linker)
    path = aside.replace(out / f'{target.name}.so')
    return (f'{path}: {len(codes)} of {len(paths)} kernels, '
            f'{path.stat().st_size / 2 ** 20:.1f} MiB')


def main(arguments: Sequence[str], stream: TextIO = sys.stdout) -> int:
    """Make the libraries that the command line names."""
    parser = ArgumentParser(prog='python -m scripts.make_kernels', description=__doc__)
    parser.add_argument('targets', nargs='*', metavar='TARGET', help=', '.join(TARGETS))
    parser.add_argument('--out', type=Path, default=SHIPPED, metavar='DIRECTORY',
                        help='of the libraries, isa_ros/kernels')
    parser.add_argument('--own', action='store_true', help='all targets that run on this machine')
    parser.add_argument('--all', action='store_true', help='all targets')
    given = parser.parse_args(arguments)
    unknown = [name for name in given.targets if name not in TARGETS]
    if unknown:
        parser.error(f'target {unknown[0]}: unknown, valid: {", ".join(TARGETS)}')
    targets = (list(TARGETS) if given.all else own_targets() if given.own
               else given.targets or [own_target().name])
    given.out.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(dir=given.out, prefix='.') as directory:
        objects = Objects(Path(directory), tuple(targets))
        making = Making(objects, KernelProgress(stream))
        making.run(len(os.sched_getaffinity(0)))
        for symbol, refused in making.refused.items():
            for name, reason in refused.items():
                print(f'{name}: not {symbol.rpartition("_")[0]}, {reason}', file=stream)
        for name in targets:
            print(link(TARGETS[name], making.refused, objects, given.out), file=stream)
    return 0


if __name__ == '__main__':
    try:
        sys.exit(main(sys.argv[1:]))
    except KeyboardInterrupt:
        print('\nkernels: interrupted, they are compiled at their first use', file=sys.stderr)
        sys.exit(130)
