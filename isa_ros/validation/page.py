"""The entries as text, as JSON, and as the page docs/validation.md with its figures."""

from collections.abc import Iterable, Sequence
import math
from pathlib import Path
from typing import Any, TypeVar

from isa_ros.paper.printed import cell, Printed, statement
from isa_ros.text.page import Page
from isa_ros.text.table import aligned
from isa_ros.validation.entry import (
    AS_READ, Entry, INPUT, NOT_REACHED, OWN, PAPER, REACHED, RETUNED, WORDS)
from isa_ros.validation.runner import GroupResult

PAGE = 'validation.md'
T = TypeVar('T')
_COUNTED = {(PAPER, False): 'printed number, simulated',
            (PAPER, True): 'printed number, simulated with retuned gains',
            (WORDS, False): 'statement in words, simulated',
            (WORDS, True): 'statement in words, simulated with retuned gains',
            (INPUT, False): 'printed input, read back', (AS_READ, False): AS_READ,
            (OWN, False): 'own'}
_DIGITS = 4   # of values
_BOUND_DIGITS = 6   # of tolerances, which may be narrower than the digits of a value
_HEAD = f"""# Validation

The statements of the paper, and targets of our own, beside what the shipped actuators give.

- Source `{PAPER}`: a printed number, range or bound, beside what a simulation gives, in an
  interval from the paper's own precision: half of the last printed digit, the bound or range.
- Source `{WORDS}`: a comparison that the paper has in words, beside a simulation; only its
  direction is judged.
- Source `{INPUT}`: a printed value that the actuators are built on, read back through the
  equations that use it. It guards the equations; a value that was put in comes out.
- Source `{OWN}`: a target of our own, or an independent result; the entry says which. These
  guard against regressions and say nothing about the paper.

Of the paper its text was read; none of its figures and no measured data were available. A number
said to be of a figure stands in the caption or in the text.

No public log of an ISA, of HyQ or of HyQ-REAL with the pressures of its chambers was found, so
that nothing on this page is held against a measured one of these. The public one of HyQ, the DLS
Quadruped Proprioceptive Sensor Dataset
([doi:10.21227/4vxz-xw05](https://doi.org/10.21227/4vxz-xw05)), has encoders, forces and inertial
units by its description, neither pressures nor valves; it was not tried. What `isa against`
showed on public records of other machines is on [real data](real_data.md#public-records): a
model with assumed sizes follows the motion of a servo-hydraulic press to a NRMSE of 0.46, of
0.27 with two gains free, and its force not at all; a record without pressures determines little.

`{REACHED}`: inside the tolerance. `{AS_READ}`: the printed value is not met, or
allows more than one reading; ours is inside the tolerance around a reading of it, whose reason is
in [paper-errata.md](paper-errata.md). The summary counts these apart from the printed ones.
`{NOT_REACHED}`: outside; the cause is below the table. Where two sets of gains are simulated, each
has its column: `table_4`, the gains of Table 4 as they are read, and `default`, the retuned ones
that are shipped. The summary counts those apart, for they were tuned to reach what the paper
prints. Which parameter is noticed by which entry is in [sensitivity.md](sensitivity.md).

This page and its figures are written by

    ./isa validate --out docs

The command exits with 0 if every entry is reached, or reached as it is read, and with 1 if any is
not reached. `--only GROUP` or `--only GROUP.ENTRY` runs a part.
"""


def as_text(results: Sequence[GroupResult]) -> str:
    """Return the table a terminal shows."""
    blocks = []
    for result in results:
        lines = aligned([('', 'source', 'paper', 'ours', 'unit', 'tolerance', 'verdict'), *(
            (f'{result.group}.{e.key}', e.source, number(e.paper), number(e.ours), unit(e),
             interval(e), e.verdict) for e in result.entries)])
        seen = aligned([('observed', 'paper', 'ours', 'unit', 'how'), *(
            (f'{result.group}.{o.name}', o.paper, number(o.ours), o.unit, o.how)
            for o in result.observations)]) if result.observations else []
        blocks.append('\n'.join([result.title, *lines, *_missed(result), *seen]))
    return '\n\n'.join([*blocks, summary(results)])


def summary(results: Sequence[GroupResult]) -> str:
    """Return how many entries of each kind are reached, in one line."""
    return '; '.join(f'{kind}: {reached} of {reached + missed} reached'
                     for kind, (reached, missed) in _counted(results).items())


def _counted(results: Sequence[GroupResult]) -> dict[str, tuple[int, int]]:
    """Return how many entries are reached and missed, by what an entry can say of the paper."""
    entries = [entry for result in results for entry in result.entries]
    kinds = {kind: [entry.is_reached for entry in entries if _kind(entry) == kind]
             for kind in _COUNTED.values()}
    return {kind: (sum(reached), len(reached) - sum(reached)) for kind, reached in kinds.items()}


def _kind(entry: Entry) -> str:
    if entry.is_read_otherwise:
        return _COUNTED[AS_READ, False]
    return _COUNTED[entry.source, entry.source in (PAPER, WORDS) and entry.gains == RETUNED]


def _missed(result: GroupResult) -> list[str]:
    return [f'{result.group}.{e.key} is not reached: {e.reason or "for no known reason"}'
            for e in result.entries if not e.is_reached]


def number(value: float | str) -> str:
    """Return a value with as many digits as are shown."""
    return value if isinstance(value, str) else f'{value:.{_DIGITS}g}'


def unit(entry: Entry) -> str:
    """Return the unit, nothing for a plain number."""
    return '' if entry.unit == '1' else entry.unit


def interval(entry: Entry) -> str:
    """Return the tolerance: lowest to highest, or its one bound."""
    lowest, highest = entry.tolerance
    if math.isinf(highest):
        return f'>= {lowest:.{_BOUND_DIGITS}g}'
    if math.isinf(lowest):
        return f'<= {highest:.{_BOUND_DIGITS}g}'
    return f'{lowest:.{_BOUND_DIGITS}g} to {highest:.{_BOUND_DIGITS}g}'


def as_tree(results: Sequence[GroupResult]) -> list[dict[str, Any]]:
    """Return every entry for JSON; a bound that is not there, and NaN, is null."""
    return [{
        'name': f'{result.group}.{entry.key}',
        'source': entry.source,
        'where': entry.where,
        'gains': entry.gains,
        'paper': entry.paper,
        'ours': _finite(entry.ours),
        'unit': entry.unit,
        'tolerance': [_finite(bound) for bound in entry.tolerance],
        'tolerance_source': entry.tolerance_source,
        'reading': entry.reading,
        'verdict': entry.verdict,
        'reason': '' if entry.is_reached else entry.reason,
    } for result in results for entry in result.entries]


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def write_page(results: Sequence[GroupResult], directory: Path) -> list[Path]:
    """Write validation.md and figures/validation_*.png into a directory; return their paths."""
    page = Page(PAGE, _HEAD)
    page.table([('', 'entries', 'reached', 'not reached'), *(
        (kind, str(reached + missed), str(reached), str(missed))
        for kind, (reached, missed) in _counted(results).items())], 'lr')
    for result in results:
        page.section(result.title)
        page.table(_rows(result))
        page.items(_missed(result))
        if result.observations:
            page.paragraph('Observed, and not judged: the paper names no bar.')
            page.table([('observation', 'where', 'paper', 'ours', 'unit', 'how'), *(
                (f'{result.group}.{o.name}', o.where, o.paper, number(o.ours), o.unit, o.how)
                for o in result.observations)])
        for picture in result.pictures:
            page.figure(f'validation_{picture.name}', picture.caption, picture.png)
            page.paragraph(picture.caption)
    page.section('Printed, and not compared')
    page.table([('where', 'what', 'printed', 'why not'), *(
        (printed.where, printed.what, f'{printed.text} {printed.unit}', why)
        for printed, why in _left_out())])
    return page.write(directory)


def _rows(result: GroupResult) -> list[tuple[str, ...]]:
    """Return the table of a group: a row a check, with a column for each set of gains."""
    sets = _in_order(entry.gains for entry in result.entries)
    checks = _in_order(_same(entry) for entry in result.entries)
    head = ('entry', 'source', 'where', 'paper', *(gains or 'ours' for gains in sets), 'unit',
            'tolerance', 'from', 'reading', 'verdict')
    return [head, *(
        _cells(result.group, sets, {
            entry.gains: entry for entry in result.entries if _same(entry) == check})
        for check in checks)]


def _same(entry: Entry) -> tuple[str, tuple[float, float]]:
    """Return what the entries of one row have in common; their gains differ."""
    return entry.name, entry.tolerance


def _in_order(values: Iterable[T]) -> list[T]:
    return list(dict.fromkeys(values))


def _cells(group: str, sets: Sequence[str], found: dict[str, Entry]) -> tuple[str, ...]:
    """Return a row of the page's table; ``found`` are its entries by their gains."""
    first = next(iter(found.values()))
    verdicts = {gains: f'**{each.verdict}**' if each.verdict == NOT_REACHED else each.verdict
                for gains, each in found.items()}
    same = len(set(verdicts.values())) == 1 and len(sets) == len(found)
    return (f'{group}.{first.name}', first.source, first.where, number(first.paper),
            *(number(found[gains].ours) if gains in found else '' for gains in sets),
            unit(first), interval(first), first.tolerance_source,
            '; '.join(_in_order(each.reading for each in found.values() if each.reading)),
            verdicts[first.gains] if same or not first.gains else ', '.join(
                f'{gains}: {verdict}' for gains, verdict in verdicts.items()))


def _left_out() -> tuple[tuple[Printed, str], ...]:
    """Return the printed values that no entry compares, each with the reason."""
    return (
        (cell('table_3', 'Encoder Baud rate', 'ISA'),
         'in the variant `data_sheet_sensors` only: a position takes some tens of microseconds '
         'on the line, so that it is read one conversion later'),
        (cell('table_3', 'Max current', 'ISA'),
         'not modelled: the supply current of the board (erratum 24)'),
        (cell('table_2', 'Operating temperature (lowest)', 'ISA v5'),
         'not compared: it is the range of the parameters'),
        (cell('table_4', 'Position K_p', 'ISA V5'),
         'a gain that changes with the task (asterisk, erratum 12): section 5.2 prints the '
         'one of the drop, which is compared'),
        (cell('table_4', 'Position K_d', 'ISA V5'), 'likewise'),
        (cell('table_4', 'Spool K_p', 'ISA V5'),
         'in the variant `explicit` only (erratum 10), by the bandwidth it gives'),
        (statement('impact_time'),
         'the origin of the time axis of Fig 20 is not printed; the fall is compared by '
         'its height'),
    )
