"""The rows as text, as JSON, and as the page docs/bench.md with its figure."""

from dataclasses import asdict, dataclass
import io
import json
from pathlib import Path
from typing import Any

from isa_ros.bench import growth
from isa_ros.bench.growth_figure import growth_figure
from isa_ros.bench.host import Machine
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.row import Row
from PIL import Image

PAGE, FIGURE = 'bench.md', 'figures/bench_growth.png'
COLORS = 64     # of the figure
HEAD = f'{"measurement":52} {"median":>10} {"unit":8} {"ratio":>8}  to'
_HEAD = """# How fast, and what limits it

Measured and written, with its figure, in one call of

    ./isa bench --out docs

on

    {machine}

Every row is a median, with the lowest and the highest in brackets; a ratio is in the direction in
which more is better, to a floor of the same call. Whole runs take 1 ms ticks with recording, each
run in a process of its own, in rounds of alternating order. The peers carry the same steps and
answers between the same actuators, shared load and recorder, and give the same bag, byte for
byte; isa_ros also looks for setpoints, requests and listeners. In processes, the phase
*actuators* is the wait for them.
"""


@dataclass(frozen=True)
class Section:
    """The rows of one group."""

    name: str
    title: str
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Report:
    """Everything that one call has measured, and where."""

    machine: Machine
    sections: tuple[Section, ...]
    outcomes: Outcomes


def as_lines(section: Section) -> list[str]:
    """Return the lines that a terminal shows."""
    lines = [f'{section.title} ({section.name})']
    for row in section.rows:
        ratio = '' if row.ratio is None else f'{row.ratio:.3g}'
        line = (f'{_indented(row, "  "):52} {_number(row.value):>10} {row.unit:8} {ratio:>8}  '
                f'{row.floor}')
        lines.append(line.rstrip() + _verdict(row))
        if row.note:
            lines.append(f'    {row.note}')
    return lines


def _verdict(row: Row) -> str:
    if row.is_reached is None:
        return ''
    return f'; aim {row.aim}: {"reached" if row.is_reached else "not reached"}'


def _number(value: float | None) -> str:
    """Return four digits, also of large numbers; - for none."""
    if value is None:
        return '-'
    return f'{value:.0f}' if abs(value) >= 1e4 else f'{value:.4g}'


def as_tree(report: Report) -> dict[str, Any]:
    """Return everything for JSON, every run with what it told."""
    return {
        'machine': asdict(report.machine),
        'rows': [{
            'group': section.name, **asdict(row),
            'aim': None if row.aim is None else str(row.aim), 'is_reached': row.is_reached,
        } for section in report.sections for row in section.rows],
        'runs': [{'spec': asdict(spec), **asdict(run)} for spec, run in report.outcomes.runs],
    }


def write_json(report: Report, path: Path) -> None:
    """Write everything as JSON."""
    path.write_text(
        json.dumps(as_tree(report), indent=2, allow_nan=False) + '\n', encoding='utf-8')


def write_page(report: Report, directory: Path) -> list[Path]:
    """Write bench.md, and the figure of the growth where that was measured."""
    directory.mkdir(parents=True, exist_ok=True)
    blocks = [_HEAD.format(machine=report.machine.summary), *_aims(report)]
    written = [directory / PAGE]
    curves = {name: growth.curve(specs, report.outcomes) for name, specs in (
        ('one process', growth.IN_ONE_PROCESS), ('processes', growth.IN_PROCESSES))}
    has_figure = all(len(curve) > 1 for curve in curves.values())
    for section in report.sections:
        blocks += _markdown(section)
        if section.name == 'growth' and has_figure:
            written.append(directory / FIGURE)
            written[-1].parent.mkdir(exist_ok=True)
            written[-1].write_bytes(_png(curves))
            blocks += [f'![Ticks per second over the number of actuators]({FIGURE})', '']
    written[0].write_text('\n'.join(blocks).rstrip() + '\n', encoding='utf-8')
    return written


def _aims(report: Report) -> list[str]:
    """Return the aims and, for each that is not reached, what limits it."""
    rows = [row for section in report.sections for row in section.rows if row.aim is not None]
    if not rows:
        return []
    lines = ['## Aims', '', '| | aim | here | |', '|---|---|---|---|']
    for row in rows:
        verdict = {True: 'reached', False: '**not reached**', None: row.note}[row.is_reached]
        here = _spread(row) if row.value is None else f'{_spread(row)} {row.unit}'
        lines.append(f'| {row.name} | {row.aim} | {here} | {verdict} |')
    missed = [row for row in rows if row.is_reached is False]
    if missed:
        lines += ['', 'What limits those that are not reached, from the laps of the coordinator:',
                  '', *(f'- {row.name}: {row.note}.' for row in missed)]
    return [*lines, '']


def _spread(row: Row) -> str:
    if row.lowest is None or row.highest is None or row.lowest == row.highest:
        return _number(row.value)
    return f'{_number(row.value)} ({_number(row.lowest)} to {_number(row.highest)})'


def _markdown(section: Section) -> list[str]:
    """Return the table of one group."""
    lines = [f'## {section.title}', '', f'`isa bench --only {section.name}`', '',
             '| | median | unit | ratio | to |', '|---|---|---|---|---|']
    for row in section.rows:
        ratio = '' if row.ratio is None else f'{row.ratio:.3g}'
        beside = row.note if row.value is None else row.floor
        lines.append(f'| {_indented(row, "&emsp;")} | {_spread(row)} | {row.unit} | {ratio} | '
                     f'{beside} |')
    return [*lines, '']


def _indented(row: Row, space: str) -> str:
    """Return the name, a part's behind a space."""
    return f'{space if row.part_of else ""}{row.name}'


def _png(curves: growth.Curves) -> bytes:
    """Return the figure with a palette, without the name of the program."""
    drawn, small = io.BytesIO(), io.BytesIO()
    growth_figure(curves).savefig(drawn, format='png')
    with Image.open(drawn) as image:
        image.convert('RGB').quantize(COLORS, dither=Image.Dither.NONE).save(
            small, format='png', optimize=True)
    return small.getvalue()
