"""What was found as text, as JSON, and as the page docs/validation.md with its figures."""

from collections.abc import Sequence
import json
import math
from pathlib import Path
from typing import Any

from isa_ros.analysis.validation.entry import AS_READ, Entry, NOT_REACHED, REACHED
from isa_ros.analysis.validation.runner import Result
from isa_ros.text.page import Page
from isa_ros.text.table import aligned

PAGE = 'validation.md'
_DIGITS = 4   # of values
_BOUND_DIGITS = 6   # of tolerances, which may be narrower than the digits of a value
_HEAD = """# Validation

Every number of the paper that the simulator can answer, beside what the shipped actuators give;
one parameter set per actuator. `reached`: inside the tolerance. `reached as read`: inside the
tolerance around the reading of a printed value that contradicts the paper itself
([paper-errata.md](paper-errata.md)). This page and its figures are written by

    ./isa validate --out docs
"""
_COLUMNS = ('entry', 'source', 'paper', 'ours', 'unit', 'tolerance', 'from', 'reading', 'verdict')


def as_text(results: Sequence[Result]) -> str:
    """Return the table a terminal shows."""
    blocks = []
    for result in results:
        lines = aligned([('', 'paper', 'ours', 'unit', 'tolerance', 'verdict'), *(
            (f'{result.group}.{e.name}', number(e.paper), number(e.ours), unit(e), interval(e),
             e.verdict) for e in result.entries)])
        blocks.append('\n'.join([result.title, *lines, *_missed(result)]))
    return '\n\n'.join([*blocks, summary(results)])


def summary(results: Sequence[Result]) -> str:
    """Return how many entries have which verdict, in one line."""
    verdicts = [entry.verdict for result in results for entry in result.entries]
    return f'{len(verdicts)} entries: ' + ', '.join(
        f'{verdicts.count(verdict)} {verdict}' for verdict in (REACHED, AS_READ, NOT_REACHED))


def _missed(result: Result) -> list[str]:
    return [f'{result.group}.{e.name} is not reached: {e.reason or "for no known reason"}'
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


def as_tree(results: Sequence[Result]) -> list[dict[str, Any]]:
    """Return every entry for JSON; a bound that is not there, and NaN, is null."""
    return [{
        'name': f'{result.group}.{entry.name}',
        'source': entry.source,
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


def write_json(results: Sequence[Result], path: Path) -> None:
    """Write every entry as JSON."""
    path.write_text(
        json.dumps(as_tree(results), indent=2, allow_nan=False) + '\n', encoding='utf-8')


def write_page(results: Sequence[Result], directory: Path) -> list[Path]:
    """Write validation.md and figures/validation_*.png into a directory; return their paths."""
    page = Page(PAGE, _HEAD)
    page.paragraph(f'{summary(results)}.')
    for result in results:
        page.section(result.title)
        page.table([_COLUMNS, *(_cells(result, entry) for entry in result.entries)])
        page.items(_missed(result))
        for picture in result.pictures:
            page.figure(f'validation_{picture.name}', picture.caption, picture.png)
            page.paragraph(picture.caption)
    return page.write(directory)


def _cells(result: Result, entry: Entry) -> tuple[str, ...]:
    """Return a row of the page's table."""
    verdict = f'**{entry.verdict}**' if entry.verdict == NOT_REACHED else entry.verdict
    return (f'{result.group}.{entry.name}', entry.source, number(entry.paper),
            number(entry.ours), unit(entry), interval(entry), entry.tolerance_source,
            entry.reading, verdict)
