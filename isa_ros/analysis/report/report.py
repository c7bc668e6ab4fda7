"""A run on one page: its figures and its extreme values, from the bag alone."""

import base64
from collections.abc import Mapping, Sequence
import html
from pathlib import Path

from isa_ros.analysis.report.ending import ending
from isa_ros.analysis.report.energy import (
    energy_legend, energy_table, PARTS_LEGEND, parts_table, recorded_accounts)
from isa_ros.analysis.report.events import event_rows, recorded_events
from isa_ros.analysis.report.figures import circuit_signals, figures
from isa_ros.analysis.report.paper_figures import paper_figure
from isa_ros.analysis.signals.signals import read_signals, Signals
from isa_ros.bag.provenance import SCENARIO
from isa_ros.bag.reader import Bag
from isa_ros.config.runs.supplies import GAS
from isa_ros.config.text.names import flat
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import parse
from isa_ros.core.atomic_file import replace_file
from isa_ros.core.units import MPA
from isa_ros.errors import BagError
from isa_ros.run.events import Event
from isa_ros.scenario.scenario import figure_of
from isa_ros.text.page import png
import numpy as np

_GENERATOR = '<meta name="generator" content="isa_ros">'
_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">{generator}
<title>{title}</title>
<style>
body {{ font-family: sans-serif; max-width: 60em; margin: 2em auto; }}
td, th {{ padding: 0.2em 0.8em; text-align: right; }}
td:first-child, th:first-child {{ text-align: left; }}
img {{ max-width: 100%; }}
</style></head>
<body><h1>{title}</h1>{ending}<p>{summary}</p><table>{rows}</table>{events}{images}{energy}
</body></html>
"""


def write_report(bag: Path, page: Path) -> list[Path]:
    """
    Write the page and, beside it, each of its figures as PNG; return the written files.

    Raises
    ------
    BagError
        The bag cannot be read or has no samples, or the page would replace another file.

    """
    _refuse_others(page)
    signals = read_signals(bag, needs_values=False)
    page.parent.mkdir(parents=True, exist_ok=True)
    written, images = [page], []
    events = recorded_events(Bag(bag), signals.run)
    drawn = figures(signals, events)
    name_of_paper = None if signals.problem else figure_of(
        parse(Bag(bag).provenance.scenario, SCENARIO), Place(SCENARIO))
    if name_of_paper is not None:
        drawn = {name_of_paper: paper_figure(name_of_paper, signals)} | drawn
    paths = {name: page.with_name(f'{page.stem}_{flat(name)}.png') for name in drawn}
    _refuse_foreign(paths, page)
    for name, figure in drawn.items():
        replace_file(paths[name], drawing := png(figure), is_durable=False)
        written.append(paths[name])
        encoded = base64.b64encode(drawing).decode()
        images.append(f'<img alt="{html.escape(name)}" src="data:image/png;base64,{encoded}">')
    text = _PAGE.format(
        generator=_GENERATOR, title=html.escape(signals.run.name),
        ending=f'<p><b>{html.escape(ended)}</b></p>' if (ended := ending(Bag(bag))) else '',
        summary=html.escape(_summary(signals)), rows=_rows(extremes(signals)),
        events=_events(events), images=''.join(images), energy=_energy(bag))
    replace_file(page, text.encode(), is_durable=False)
    return written


def _refuse_foreign(paths: Mapping[str, Path], page: Path) -> None:
    """Refuse to replace figures that are not those of the report there is."""
    there = page.read_text(encoding='utf-8', errors='replace') if page.exists() else ''
    for name, path in paths.items():
        if path.exists() and f'<img alt="{html.escape(name)}"' not in there:
            raise BagError(
                f'{path} already exists and is not a figure of {page.name}, so it is not '
                'overwritten')


def _refuse_others(page: Path) -> None:
    """Refuse to replace a file that is not a report."""
    if page.is_dir():
        raise BagError(f'{page}: is a directory, must be the name of the page')
    if page.exists():
        with page.open('rb') as file:
            if _GENERATOR.encode() not in file.read(len(_PAGE)):
                raise BagError(
                    f'{page} already exists and is not a report, so it is not overwritten')


def extremes(signals: Signals) -> list[tuple[str, float, float, str]]:
    """Return (signal, least, greatest, unit) of actuators, circuits and ground, as recorded."""
    values = []
    for actuator in signals.run.actuators:
        name = actuator.name
        pressures = [signals.drawn(f'{name}.pressure_{side}').values / MPA for side in 'ab']
        for signal, series, unit in (
                *((field, signals[f'{name}.{field}'], signals.unit(f'{name}.{field}'))
                  for field in ('position', 'force') if f'{name}.{field}' in signals),
                ('pressure', np.concatenate(pressures), 'MPa gauge')):
            if len(series):
                values.append((f'{name} {signal}', float(series.min()), float(series.max()), unit))
        cushion = signals.drawn(f'{name}.cushion_pressure').values / MPA
        if cushion.any():
            values.append((f'{name} cushion pressure', 0.0, float(cushion.max()), 'MPa gauge'))
    for supply in signals.run.supplies:
        for name, recorded in circuit_signals(supply, signals).items():
            is_gas = name.endswith(GAS)
            series = recorded.values if is_gas else recorded.values / MPA
            values.append((
                f'{name.rpartition(".")[0]} {"gas temperature" if is_gas else "pressure"}',
                float(series.min()), float(series.max()), 'celsius' if is_gas else 'MPa gauge'))
    for leg in signals.run.legs:
        if f'{leg.name}.foot_force' not in signals:
            continue
        ground = signals[f'{leg.name}.foot_force'][:, 2]
        values.append((
            f'{leg.prefix}ground force', float(ground.min()), float(ground.max()), 'N'))
    return values


def _summary(signals: Signals) -> str:
    run, end = signals.run, float(signals.time[-1])
    many = 's' if len(run.actuators) > 1 else ''
    return (f'{run.source}: {len(run.actuators)} actuator{many}, {end:.3f} s of simulation time '
            f'in steps of {run.step_ns / 1e6:g} ms.'
            f'{f" {another_version(signals)}" if signals.problem else ""}')


def another_version(signals: Signals) -> str:
    """Return a remark on signals whose configuration another version wrote."""
    return ('Another version recorded this bag: its signals are as recorded, values of its '
            f'configuration cannot be read here ({signals.problem})')


def _events(events: list[Event]) -> str:
    """Return the table of what the devices did; one line if there is nothing."""
    if not events:
        return '<h2>Events</h2><p>No condition warned or tripped, no state changed.</p>'
    return f'<h2>Events</h2>{_table(event_rows(events))}'


def _table(cells: Sequence[Sequence[str]]) -> str:
    """Return a table, its header first."""
    head, *body = [[html.escape(cell) for cell in row] for row in cells]
    rows = ''.join(f'<tr><td>{"</td><td>".join(row)}</td></tr>' for row in body)
    return f'<table><tr><th>{"</th><th>".join(head)}</th></tr>{rows}</table>'


def _energy(bag: Path) -> str:
    """Return the table of oil and energy; nothing for a bag without diagnostics."""
    accounts = recorded_accounts(Bag(bag))
    if accounts is None:
        return ''
    parts = parts_table(accounts)
    of_parts = f'{_table(parts)}<p>{html.escape(PARTS_LEGEND)}</p>' if parts else ''
    return (f'<h2>Oil and energy</h2>{_table(energy_table(accounts))}'
            f'<p>{html.escape(energy_legend(accounts))}</p>{of_parts}')


def _rows(values: list[tuple[str, float, float, str]]) -> str:
    head = '<tr><th>signal</th><th>least</th><th>greatest</th><th>unit</th></tr>'
    return head + ''.join(
        f'<tr><td>{html.escape(signal)}</td><td>{least:.4g}</td><td>{greatest:.4g}</td>'
        f'<td>{html.escape(unit)}</td></tr>' for signal, least, greatest, unit in values)
