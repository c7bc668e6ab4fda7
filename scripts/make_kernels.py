"""
Make the libraries of kernels in isa_ros/kernels, by all cores: starts then take no compiler.

    python -m scripts.make_kernels                  for the processor of this machine
    python -m scripts.make_kernels --all            for all targets, as the wheel has them
    python -m scripts.make_kernels x86-64 aarch64   for these

A library of another architecture is linked by `aarch64-linux-gnu-ld` (in the package
binutils-aarch64-linux-gnu); without it it is left out, and a line says so. What a library does
not have is compiled at its first use.
"""

from argparse import ArgumentParser
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, wait
import multiprocessing
import os
from pathlib import Path
import shutil
import sys
import time
from typing import Any, NamedTuple, TextIO

from isa_ros.core.kernel_library import SHIPPED
from isa_ros.core.objects import library_of, object_of, own_target, Target, TARGETS
from isa_ros.errors import ConfigError
from scripts.kernel_rehearsal import ALONE, rehearsals, rehearse, Wanted

PERIOD_S = 1.5          # between two lines
_REHEARSAL = 30         # size of one, in kernels


class Job(NamedTuple):
    """Work of one process: a rehearsal, or the objects of an entry."""

    size: int
    work: Callable[..., Any]
    arguments: tuple[Any, ...]
    name: str


class Made(NamedTuple):
    """The objects of one entry by target, and why a target has none."""

    objects: dict[str, bytes]
    refused: dict[str, str]


def make(wanted: Wanted, targets: Sequence[str]) -> Made:
    """Return the objects of an entry for targets."""
    made = Made({}, {})
    for name in targets:
        try:
            made.objects[name] = object_of({wanted.symbol: wanted.entry}, TARGETS[name])
        except ConfigError as error:
            made.refused[name] = str(error).rpartition(': ')[2]
    return made


class Progress:
    """Prints how many kernels are made, and the time left by their sizes."""

    def __init__(self, stream: TextIO, clock: Callable[[], float] = time.monotonic) -> None:
        self._stream, self._clock = stream, clock
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
        rest = f'{spent * self.left / self.done:.0f} s left' if self.done else 'beginning'
        self._stream.write(
            f'kernels: {self.made} of {self.total}, {spent:.0f} s, '
            + ('finished' if is_last else f'{rest}: {", ".join(running)}') + '\n')
        self._stream.flush()


class Making:
    """The jobs of all processes, the largest first."""

    def __init__(self, targets: Sequence[str], progress: Progress) -> None:
        self._targets, self._progress = targets, progress
        self._waiting: list[Job] = []
        self._running: dict[Future[Any], Job] = {}
        self.made: dict[str, Made] = {}
        """By symbol."""
        for name in rehearsals():
            self._add(Job(_REHEARSAL, rehearse, (name,), f'kernels of {name}'))

    def _add(self, job: Job) -> None:
        self._waiting.append(job)
        self._waiting.sort(key=lambda own: (own.size, own.name == f'kernels of {ALONE}'))
        self._progress.left += job.size

    def run(self, processes: int) -> None:
        """Do all jobs."""
        context = multiprocessing.get_context('spawn')
        with ProcessPoolExecutor(processes, context) as pool:
            while self._waiting or self._running:
                while self._waiting and len(self._running) < processes:
                    job = self._waiting.pop()
                    self._running[pool.submit(job.work, *job.arguments)] = job
                for future in wait(self._running, PERIOD_S, 'FIRST_COMPLETED').done:
                    self._take(self._running.pop(future), future.result())
                self._progress.show([job.name for job in self._running.values()])
        self._progress.show([], is_last=True)

    def _take(self, job: Job, result: Any) -> None:
        progress = self._progress
        progress.done, progress.left = progress.done + job.size, progress.left - job.size
        if isinstance(result, Made):
            self.made[job.arguments[0].symbol] = result
            progress.made += 1
            return
        for wanted in result:
            if wanted.symbol not in self.made:
                self.made[wanted.symbol] = Made({}, {})
                progress.total += 1
                self._add(Job(wanted.size, make, (wanted, self._targets), wanted.name))


def link(target: Target, made: Sequence[Made], out: Path) -> str:
    """Write the library of a target; return a line about it."""
    is_own = target.triple == own_target().triple
    linker = 'cc' if is_own else f'{target.triple.replace("unknown-", "")}-ld'
    if shutil.which(linker) is None:
        return f'{target.name}: left out, there is no {linker} to link it with'
    objects = [own.objects[target.name] for own in made if target.name in own.objects]
    aside = out / f'.{target.name}.part'
    library_of(objects, aside, linker)
    path = aside.replace(out / f'{target.name}.so')
    return (f'{path}: {len(objects)} of {len(made)} kernels, '
            f'{path.stat().st_size / 2 ** 20:.1f} MiB')


def main(arguments: Sequence[str], stream: TextIO = sys.stdout) -> int:
    """Make the libraries that the command line names."""
    parser = ArgumentParser(prog='python -m scripts.make_kernels', description=__doc__)
    parser.add_argument('targets', nargs='*', metavar='TARGET', help=', '.join(TARGETS))
    parser.add_argument('--out', type=Path, default=SHIPPED, metavar='DIRECTORY',
                        help='of the libraries, isa_ros/kernels')
    parser.add_argument('--all', action='store_true', help='all targets')
    given = parser.parse_args(arguments)
    unknown = [name for name in given.targets if name not in TARGETS]
    if unknown:
        parser.error(f'target {unknown[0]}: unknown, valid: {", ".join(TARGETS)}')
    targets = list(TARGETS) if given.all else given.targets or [own_target().name]
    making = Making(targets, Progress(stream))
    making.run(len(os.sched_getaffinity(0)))
    given.out.mkdir(parents=True, exist_ok=True)
    for symbol, own in making.made.items():
        for name, reason in own.refused.items():
            print(f'{name}: not {symbol.rpartition("_")[0]}, {reason}', file=stream)
    for name in targets:
        print(link(TARGETS[name], list(making.made.values()), given.out), file=stream)
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
