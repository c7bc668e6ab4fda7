"""Output of the rows as text, as JSON, and as the page docs/bench.md with its figure."""

from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

from isa_ros.bench.host import Machine
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.row import Row
from isa_ros.core.frozen import frozen
from isa_ros.text.page import Page, png_with_palette
from isa_ros.text.table import digits, padded
from matplotlib.figure import Figure

PAGE = 'bench.md'
_WIDTHS, _SIDES = (52, 9, 7, 8, 0), 'lrlrl'
HEAD = padded(('measurement', 'median', 'unit', 'ratio', 'to'), _WIDTHS, _SIDES)
_HEAD = """# How fast, and what limits it

Measured and written, with its figure, in one call of

    ./isa bench{options} --out docs

on

    {machine}

Every row is a median, of several runs with the lowest and the highest value in brackets. A ratio
compares it with a floor of the same call, so that more is better; that of a part is its share of
the whole. Whole runs have ticks of 1 ms and record a bag; each run is in its own process, in
rounds of alternating order. The peers transmit the same steps and answers between the same
actuators, surroundings and recorder, and give the same bag, byte for byte; isa_ros also checks for
setpoints, requests and subscriptions. In processes, the phase *actuators* is the wait for them.
"""


class BenchDrawing(NamedTuple):
    """A figure of a group."""

    caption: str
    figure: Figure


@frozen
class Section:
    """The rows of one group."""

    name: str
    title: str
    rows: tuple[Row, ...]
    drawing: BenchDrawing | None = None


@frozen
class Report:
    """Measurements of one call, and the machine."""

    machine: Machine
    sections: tuple[Section, ...]
    outcomes: Outcomes
    options: str = ''
    """Of the call, each after a space."""


def as_lines(section: Section) -> list[str]:
    """Return the lines of a section for a terminal."""
    lines = [f'{section.title} ({section.name})']
    for row in section.rows:
        lines.append(padded((_indented(row, '  '), digits(row.value, 4), row.unit, _ratio(row),
                             row.floor), _WIDTHS, _SIDES) + _verdict(row))
        if row.note:
            lines.append(f'    {row.note}')
    return lines


def _verdict(row: Row) -> str:
    if row.is_reached is None:
        return ''
    return f'; aim {row.aim}: {"reached" if row.is_reached else "not reached"}'


def as_tree(report: Report) -> dict[str, Any]:
    """Return the report for JSON, with the measured values of every run."""
    return {
        'machine': asdict(report.machine),
        'rows': [{
            'group': section.name, **asdict(row),
            'aim': None if row.aim is None else str(row.aim), 'is_reached': row.is_reached,
        } for section in report.sections for row in section.rows],
        'runs': [{'spec': asdict(spec), **asdict(run)} for spec, run in report.outcomes.runs],
    }


def write_page(report: Report, directory: Path) -> list[Path]:
    """Write bench.md, with the figures of the groups."""
    page = Page(PAGE, _HEAD.format(
        machine=report.machine.summary, options=report.options))
    _aims(page, report)
    for section in report.sections:
        page.section(section.title)
        page.paragraph(f'`isa bench --only {section.name}`')
        page.table([('', 'median', 'unit', 'ratio', 'to'), *map(_cells, section.rows)])
        if section.drawing is not None:
            page.figure(f'bench_{section.name}', section.drawing.caption,
                        png_with_palette(section.drawing.figure))
    return page.write(directory)


def _aims(page: Page, report: Report) -> None:
    """Add the aims and, for each that is not reached, its limits."""
    rows = [row for section in report.sections for row in section.rows if row.aim is not None]
    if not rows:
        return
    page.section('Aims')
    cells = [('', 'aim', 'here', '')]
    for row in rows:
        verdict = {True: 'reached', False: '**not reached**', None: row.note}[row.is_reached]
        here = _spread(row) if row.value is None else f'{_spread(row)} {row.unit}'
        cells.append((row.name, str(row.aim), here, verdict))
    page.table(cells)
    missed = [row for row in rows if row.is_reached is False]
    if missed:
        page.paragraph('Limits of those that are not reached, from the laps of the coordinator:')
        page.items(f'{row.name}: {row.note}.' for row in missed)


def _spread(row: Row) -> str:
    if row.lowest is None or row.highest is None or row.lowest == row.highest:
        return digits(row.value, 4)
    return f'{digits(row.value, 4)} ({digits(row.lowest, 4)} to {digits(row.highest, 4)})'


def _cells(row: Row) -> tuple[str, ...]:
    """Return a row of a group's table on the page."""
    beside = row.note if row.value is None else row.floor
    return _indented(row, '&emsp;'), _spread(row), row.unit, _ratio(row), beside


def _ratio(row: Row) -> str:
    return '' if row.ratio is None else f'{row.ratio:.3g}'


def _indented(row: Row, space: str) -> str:
    """Return the name; that of a part is indented."""
    return f'{space if row.part_of else ""}{row.name}'
