"""What was found as text, as JSON, and as the page docs/validation.md with its figures."""

from collections.abc import Sequence
import json
import math
from pathlib import Path
from typing import Any

from isa_ros.analysis.validation.entry import AS_READ, Entry, NOT_REACHED, REACHED
from isa_ros.analysis.validation.runner import Result

PAGE = 'validation.md'
FIGURES = 'figures'
_DIGITS = 4   # of values
_BOUND_DIGITS = 6   # of tolerances, which may be narrower than the digits of a value
_HEAD = """# Validation

Every number of the paper that the simulator can answer, beside what the shipped actuators give;
one parameter set per actuator. `reached`: inside the tolerance. `reached as read`: inside the
tolerance around the reading of a printed value that contradicts the paper itself
([paper-errata.md](paper-errata.md)). This page and its figures are written by

    ./isa validate --out docs

"""


def as_text(results: Sequence[Result]) -> str:
    """Return the table a terminal shows."""
    blocks = []
    for result in results:
        rows = [('', 'paper', 'ours', 'unit', 'tolerance', 'verdict')]
        rows += [(f'{result.group}.{e.name}', number(e.paper), number(e.ours), unit(e),
                  interval(e), e.verdict) for e in result.entries]
        widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
        blocks.append('\n'.join([result.title, *(
            '  '.join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip()
            for row in rows), *_missed(result)]))
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
    (directory / FIGURES).mkdir(parents=True, exist_ok=True)
    written = [directory / PAGE]
    blocks = [_HEAD + summary(results) + '.\n']
    for result in results:
        blocks.append(markdown(result))
        for picture in result.pictures:
            name = f'{FIGURES}/validation_{picture.name}.png'
            (directory / name).write_bytes(picture.png)
            written.append(directory / name)
            blocks.append(f'![{picture.caption}]({name})\n\n{picture.caption}\n')
    written[0].write_text('\n'.join(blocks), encoding='utf-8')
    return written


def markdown(result: Result) -> str:
    """Return the section of one group, without its figures."""
    lines = [f'## {result.title}', '',
             '| entry | source | paper | ours | unit | tolerance | from | reading | verdict |',
             '|---|---|---|---|---|---|---|---|---|']
    for e in result.entries:
        verdict = f'**{e.verdict}**' if e.verdict == NOT_REACHED else e.verdict
        cells = (f'{result.group}.{e.name}', e.source, number(e.paper), number(e.ours), unit(e),
                 interval(e), e.tolerance_source, e.reading, verdict)
        lines.append(f'| {" | ".join(cell.replace("|", "/") for cell in cells)} |')
    missed = _missed(result)
    return '\n'.join([*lines, '', *(f'- {line}' for line in missed), *([''] if missed else [])])
