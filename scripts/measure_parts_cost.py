"""
What the parts of docs/parts.md cost where they are absent; with --write into the page.

    python -m scripts.measure_parts_cost --write

The kernel of the actuators against that of the last commit without such parts, or of --against
REV: the same run file without parts, each side in a fresh process with its own compiled kernels,
calls in turn. Processor time, so that a busy host matters little; the order changes from call to
call and from pair to pair.
"""

import argparse
from collections.abc import Mapping, Sequence
from math import comb
from pathlib import Path
from statistics import median
import subprocess
import sys
import tempfile
from typing import NamedTuple

from isa_ros.bench.against import checkout
from isa_ros.bench.child import environment, ROOT
from isa_ros.bench.rigs import rigs_file
from isa_ros.config.text.yaml_text import dump, Tree
from isa_ros.errors import RunError
from isa_ros.text.marked import with_parts

PAGE = ROOT / 'docs' / 'parts.md'
CHILD = Path(__file__).with_name('time_ticks.py')
BEFORE_PARTS = '9e6088475b0ca6411fa22c1c059420a2328a246a'
PAIRS = 48
ROUNDS = 12         # calls of each side of a pair
CALL = 1200         # ticks of one actuator in a call: 15 ms
SHARE = 0.95        # of all intervals, that have the median in them


class PartCost(NamedTuple):
    """Of one case: us a tick before, and the ratio to it with its interval."""

    pairs: int
    before: float
    ratio: float
    lowest: float
    highest: float
    is_same: bool
    """Whether both sides had the same states, byte for byte."""


def rams_file(n_actuators: int) -> str:
    """Return a run file of as many ISA v5, each with a mass of its own."""
    actuators: Tree = {f'ram_{k}': {
        'model': 'isa_v5', 'load': {'kind': 'mass', 'inertia': 50.0},
        'initial_position_mm': 50.0} for k in range(n_actuators)}
    return dump({
        'name': f'rams_{n_actuators}', 'step_ms': 1.0, 'controller_offset_ms': 0.12,
        'tick_timeout_s': 5.0,
        'supply': {'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0},
        'actuators': actuators})


CASES: Mapping[str, tuple[int, str, str]] = {
    'three ISA v5, moving': (3, rams_file(3), 'moving'),
    'three ISA v5, held': (3, rams_file(3), 'held'),
    'twelve ISA v5, moving': (12, rams_file(12), 'moving'),
    'smart manifold and two ISA v5, moving': (3, rigs_file(3), 'moving')}
"""Number of actuators, run file and motion, by what they are."""


class Side:
    """One child process; its kernels are compiled once it is made."""

    def __init__(self, root: Path, run_file: Path, motion: str, n_ticks: int) -> None:
        self._process = subprocess.Popen(
            [sys.executable, str(CHILD), str(run_file), motion, str(n_ticks)], cwd=root,
            env=environment(root=root), stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, text=True)

    def call(self) -> float:
        """Return what a tick costs in one more call, us."""
        assert self._process.stdin is not None
        self._process.stdin.write('\n')
        self._process.stdin.flush()
        return float(self._line())

    def end(self) -> str:
        """Let it end; return the digest of its states."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        digest = self._line()
        self._process.wait()
        return digest

    def _line(self) -> str:
        assert self._process.stdout is not None and self._process.stderr is not None
        line = self._process.stdout.readline().strip()
        if not line:
            raise RunError(f'{CHILD.name}: {self._process.stderr.read().strip()}')
        return line


def interval(values: Sequence[float]) -> tuple[float, float]:
    """
    Return two of the values that enclose the median of all such values in `SHARE` of all cases.

    By the binomial distribution, whatever theirs is: at least six values.
    """
    n, outside, k = len(values), 2.0 / 2.0 ** len(values), 0
    if outside > 1.0 - SHARE:
        raise ValueError(f'{n} values have no such interval')
    while outside + 2.0 * comb(n, k + 1) / 2.0 ** n <= 1.0 - SHARE:
        k += 1
        outside += 2.0 * comb(n, k) / 2.0 ** n
    ordered = sorted(values)
    return ordered[k], ordered[n - 1 - k]


def pair(sides: Sequence[Side], rounds: int) -> tuple[float, float, bool]:
    """Return us a tick of the first side, the ratio of the other, whether their bytes are one."""
    found: list[tuple[float, float]] = []
    for k in range(rounds):
        costs = {side: side.call() for side in (sides if k % 2 else sides[::-1])}
        found.append((costs[sides[0]], costs[sides[1]]))
    first, second = (side.end() for side in sides)
    return (median(old for old, _ in found), median(new / old for old, new in found),
            first == second)


def cost(old: Path, case: str, pairs: int = PAIRS, rounds: int = ROUNDS) -> PartCost:
    """Return the cost of a case against the files in ``old``."""
    n_actuators, text, motion = CASES[case]
    found = []
    with tempfile.TemporaryDirectory(prefix='isa_parts_') as directory:
        run_file = Path(directory) / 'run.yaml'
        run_file.write_text(text, encoding='utf-8')
        for k in range(pairs):
            order = 1 if k % 2 else -1
            sides = [Side(root, run_file, motion, CALL // n_actuators)
                     for root in (old, ROOT)[::order]]
            found.append(pair(sides[::order], rounds))
    ratios = [ratio for _, ratio, _ in found]
    return PartCost(pairs, median(own[0] for own in found), median(ratios), *interval(ratios),
                    all(own[2] for own in found))


def row(case: str, own: PartCost) -> str:
    """Return a row of the table of the page."""
    return (f'| {case} | {own.pairs} | {own.before:.1f} us | {own.ratio:.3f} '
            f'| {own.lowest:.3f} to {own.highest:.3f} | {"same" if own.is_same else "OTHERS"} |')


def table(old: Path, pairs: int) -> list[str]:
    """Return the table of the page."""
    lines = ['| actuators | pairs | a tick before | now, over before | 95 % interval | bytes |',
             '|---|---|---|---|---|---|']
    for case in CASES:
        lines.append(row(case, cost(old, case, pairs)))
        print(lines[-1], flush=True)
    return lines


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--against', metavar='REV', default=BEFORE_PARTS)
    parser.add_argument('--pairs', type=int, default=PAIRS)
    parser.add_argument('--write', action='store_true', help='into docs/parts.md')
    options = parser.parse_args()
    with checkout(options.against) as files:
        text = table(files, options.pairs)
    if options.write:
        PAGE.write_text(with_parts(PAGE.read_text(), {'cost': text}))
