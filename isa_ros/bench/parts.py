"""
The parts of a measured time, and what they do not cover.

Parts are measured one by one, the whole in one piece. If they differ by more than a stated share,
a part does other work than in the whole, and neither can be believed.
"""

from collections.abc import Callable, Iterable, Mapping
from statistics import median
import time
from typing import NamedTuple

from isa_ros.bench.row import Row

NOT_COVERED = 'not covered'
ROUNDS = 9
_SCALES = {'us': 1e6, 's': 1.0}


def _nothing() -> None:
    """Prepare nothing."""


class Work(NamedTuple):
    """Pieces of work whose time is measured together, and what is called before."""

    run: Callable[[], object]
    prepare: Callable[[], object] = _nothing
    clock: Callable[[], float] = time.thread_time
    """Processor time in s: of this thread, or `time.process_time` with that of its others."""


def divided(
        whole: Row, parts: Mapping[str, float], share: float, prefix: str = 'of it ') -> list[Row]:
    """
    Return a row of each part, and one of what the parts do not cover; negative: they overlap.

    ``whole`` is in us or s, ``parts`` are in s; ``share`` is the largest one of the whole that
    may be left, or be too much.
    """
    scale = _SCALES[whole.unit]
    rows = [Row(f'{prefix}{name}', scale * value, whole.unit, whole.name,
                scale * value / whole.number) for name, value in parts.items()]
    rows.append(left_of(whole, rows, share, prefix))
    return [row.under(whole) for row in rows]


def left_of(whole: Row, parts: Iterable[Row], share: float, prefix: str = 'of it ') -> Row:
    """Return the row of what ``parts``, in the unit of ``whole``, do not cover of it."""
    left = whole.number - sum(row.number for row in parts)
    return Row(f'{prefix}{NOT_COVERED}', left, whole.unit, whole.name, left / whole.number,
               most_share=share)


def misfits(rows: Iterable[Row]) -> list[str]:
    """Return a line for each row whose ratio is beyond its `Row.most_share`."""
    return [f'{row.part_of}: {row.name} {row.number:.3g} {row.unit}, {row.ratio:+.0%} of '
            f'{row.floor}, must be within {row.most_share:.0%}'
            for row in rows if row.most_share is not None and row.ratio is not None
            and not abs(row.ratio) <= row.most_share]


def in_turn(works: Mapping[str, Work], per: int) -> dict[str, float]:
    """
    Return the processor time for one of the ``per`` pieces of each work, s, by its clock.

    Medians of rounds in alternating order, after a warm-up: what slows the machine down meets all.
    """
    found: dict[str, list[float]] = {name: [] for name in works}
    for round_ in range(1 + ROUNDS):
        for name in list(works)[::-1] if round_ % 2 else works:
            work = works[name]
            work.prepare()
            start = work.clock()
            work.run()
            if round_:
                found[name].append((work.clock() - start) / per)
    return {name: median(times) for name, times in found.items()}
