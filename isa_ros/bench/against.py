"""
This checkout against another revision of it: the same runs, old and new in turn.

The old files are those of `git archive`, in a temporary directory; both run in the Python of this
process, whose packages may be newer than the old ones asked for. A first run of each compiles its
kernels and is not counted.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
import json
from pathlib import Path
import subprocess
import sys
import tempfile
from typing import NamedTuple

from isa_ros.bench.child import last_line, ROOT, run_module
from isa_ros.bench.leg import IN_PROCESSES
from isa_ros.bench.row import Aim, Row
from isa_ros.bench.spec import Spec, TWELVE
from isa_ros.errors import ConfigError, RunError
from isa_ros.text.progress import counted

SPECS = (IN_PROCESSES, TWELVE)
PAIRS = 3
FIRST_TIMEOUT_S = 900.0     # of a run that compiles
TIMEOUT_S = 180.0
AIM = Aim(0.3, is_most=True)
"""Of the new over the old; of a tick in processes, against the ends that Python drove."""


class Cost(NamedTuple):
    """What a tick of a run costs, s."""

    processor: float
    """Processor time of all its processes."""
    host: float


def missing(revision: str | None) -> str:
    """Return why nothing can be compared; '' if it can."""
    return '' if revision else 'needs --against REV, a commit of this checkout'


def against_rows(revision: str) -> list[Row]:
    """
    Return the ratio of this checkout to a revision, of each run; raises as `checkout` too.

    Raises
    ------
    RunError
        A run could not be completed.

    """
    with checkout(revision) as old:
        return [row for spec in SPECS
                for row in ratio_rows(spec, revision, measured_pairs(spec, old))]


@contextmanager
def checkout(revision: str) -> Iterator[Path]:
    """
    Yield a directory with the files of a revision.

    Raises
    ------
    ConfigError
        This is not a checkout, or it has no such revision.

    """
    commit = _git('rev-parse', '--verify', f'{revision}^{{commit}}')
    if commit.returncode:
        known = _git('rev-parse', '--git-dir').returncode == 0
        reason = 'no such revision' if known else f'{ROOT} is not a checkout with git'
        raise ConfigError(f'--against {revision}: {reason}')
    with tempfile.TemporaryDirectory(prefix='isa_bench_') as directory:
        archive = Path(directory) / 'old.tar'
        made = _git('archive', '--output', str(archive), commit.stdout.strip())
        if made.returncode:
            raise ConfigError(f'--against {revision}: {last_line(made)}')
        old = Path(directory) / 'old'
        old.mkdir()
        subprocess.run(['tar', '-xf', str(archive), '-C', str(old)], check=True)
        yield old


def _git(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(['git', '-C', str(ROOT), *arguments], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True)


def measured_pairs(spec: Spec, old: Path) -> list[tuple[Cost, Cost]]:
    """Return the costs of old and new of `PAIRS` runs each, in alternating order."""
    report = counted(sys.stderr, 'runs')
    roots, total = (old, ROOT), 2 * (1 + PAIRS)
    found: list[tuple[Cost, Cost]] = []
    for pair in range(1 + PAIRS):
        costs: dict[Path, Cost] = {}
        for root in roots[::-1] if pair % 2 else roots:
            name = 'this' if root == ROOT else 'old'
            if report is not None:
                report(2 * pair + len(costs), total, f'{spec}, {name}')
            costs[root] = cost_of(spec, root, TIMEOUT_S if pair else FIRST_TIMEOUT_S)
        if pair:
            found.append((costs[old], costs[ROOT]))
    if report is not None:
        report(total, total, '')
    return found


def cost_of(spec: Spec, root: Path, timeout_s: float) -> Cost:
    """Do one run with the files in ``root`` and return its cost; raises as `against_rows`."""
    with tempfile.TemporaryDirectory(prefix='isa_bench_') as directory:
        result = Path(directory) / 'result.json'
        try:
            ended = run_module(f'{__package__}.measure', [spec.to_json(), str(result)],
                               timeout_s, root)
        except subprocess.TimeoutExpired:
            raise RunError(f'{spec} of {root}: not finished after {timeout_s:g} s') from None
        if ended.returncode or not result.exists():
            raise RunError(f'{spec} of {root}: {last_line(ended)}')
        tree = json.loads(result.read_text(encoding='utf-8'))
    return Cost(sum(tree['processor'].values()), 1.0 / tree['ticks_per_s'])


def ratio_rows(spec: Spec, revision: str, pairs: Sequence[tuple[Cost, Cost]]) -> list[Row]:
    """Return the ratios of new to old, and below them the costs."""
    rows = []
    for what, title in (('processor', 'processor time of a tick'), ('host', 'a tick')):
        costs = [[1e6 * getattr(cost, what) for cost in pair] for pair in pairs]
        row = Row.of(f'{spec}: {title}, over {revision}', [new / old for old, new in costs],
                     '1').aiming(AIM)
        before, now = (Row.of(name, [pair[k] for pair in costs], 'us').under(row)
                       for k, name in enumerate((revision, 'this')))
        if row.is_reached is False:
            row = row.noting(f'{before.number:.1f} us before, {now.number:.1f} us now')
        rows += [row, before, now]
    return rows
