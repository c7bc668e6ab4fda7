"""A run on one page, from its bag alone: what ran, verdict, key figures, diagrams over time."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from isa_ros.analysis.report.document import document, Shown, Span
from isa_ros.analysis.report.ending import ending
from isa_ros.analysis.report.energy import (
    Accounts, energy_legend, energy_table, PARTS_LEGEND, parts_table, recorded_accounts)
from isa_ros.analysis.report.events import event_rows, MOST
from isa_ros.analysis.report.extremes import extreme_rows
from isa_ros.analysis.report.figures import figure_of
from isa_ros.analysis.report.files import image, refuse_foreign, write_files
from isa_ros.analysis.report.groups import groups_of
from isa_ros.analysis.report.key_figures import key_rows, landing_rows, LEGEND
from isa_ros.analysis.report.marks import Band, bands_of, marks_of
from isa_ros.analysis.report.paper_figures import paper_figure
from isa_ros.analysis.report.verdict import Statement, verdict
from isa_ros.analysis.report.what_ran import what_ran, WhatRan
from isa_ros.analysis.signals.signals import read_signals, Signals
from isa_ros.bag.provenance import SCENARIO
from isa_ros.bag.reader import Bag
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import parse
from isa_ros.run.events import Event, events_in
from isa_ros.run.recorded import history_of
from isa_ros.scenario.figures import figure_of as figure_of_scenario
from isa_ros.text.markup import details, download, lines, pairs, picture, table, tag
from matplotlib.figure import Figure


class Recorded(NamedTuple):
    """All that a report shows of a bag, read once."""

    name: str
    signals: Signals
    events: list[Event]
    bands: list[Band]
    accounts: Accounts | None
    ran: WhatRan
    verdict: list[Statement]
    figure: str | None
    """Of the paper, that the scenario is drawn as."""


def recorded(path: Path) -> Recorded:
    """
    Return what a report shows of a bag.

    Raises
    ------
    BagError
        The bag cannot be read or has no samples.
    ConfigError
        Its configuration does not even name its actuators.

    """
    bag = Bag(path)
    signals = read_signals(bag, needs_values=False).possible()
    history = history_of(bag, signals.run)
    events = events_in(signals.run, history)
    bands = bands_of(signals.run, history, float(signals.time[-1]))
    figure = None if signals.problem else figure_of_scenario(
        parse(bag.provenance.scenario, SCENARIO), Place(SCENARIO))
    return Recorded(
        name_of(path), signals, events, bands, recorded_accounts(bag),
        what_ran(bag, name_of(path), signals), verdict(signals, events, bands, ending(bag)),
        figure)


def name_of(bag: Path) -> str:
    """Return the name of a bag without its directories."""
    return bag.resolve().name


def write_report(bag: Recorded, page: Path) -> list[Path]:
    """
    Write the page and, beside it, each figure as PNG and SVG; return the paths, the page first.

    Raises
    ------
    BagError
        The page or a figure would replace another file.

    """
    groups, signals = groups_of(bag.signals), bag.signals
    names = [own.name for own in groups]
    refuse_foreign(page, [*names, *([bag.figure] if bag.figure else [])])
    shown = [Shown(own, marks_of(own.sources, bag.bands, bag.events)) for own in groups]
    figures: dict[str, Figure] = {}
    if bag.figure is not None:
        figures[bag.figure] = paper_figure(bag.figure, signals)
    figures |= {own.group.name: figure_of(*own) for own in shown}
    first = '' if bag.figure is None else _picture(bag.figure, figures[bag.figure])
    text = document(signals.run.name, head_of(bag) + first, shown, span_of([signals]))
    return write_files(page, text, figures)


def span_of(runs: Sequence[Signals]) -> Span:
    """Return the time that a page of some runs shows."""
    return Span(min(float(own.time[0]) for own in runs), max(float(own.time[-1]) for own in runs),
                min(own.run.step_ns for own in runs) * 1e-9)


def head_of(bag: Recorded) -> str:
    """Return the markup above the diagrams: verdict, key figures, what ran, tables."""
    return ''.join([
        _what_ran(bag.ran, bag.signals), tag('h2', 'Verdict'), verdict_list(bag.verdict),
        _key_figures(bag.signals), _energy(bag.accounts), _events(bag.events),
        details('Extreme values', table(extreme_rows(bag.signals)))])


def verdict_list(statements: Sequence[Statement]) -> str:
    """Return a verdict as a list, the grade of each statement as its class."""
    lines = ''.join(tag('li', own.text, own.grade) for own in statements)
    return f'<ul class="verdict">{lines}</ul>'


def _key_figures(signals: Signals) -> str:
    landed = landing_rows(signals)
    return ''.join([tag('h2', 'Key figures'), table(landed), table(key_rows(signals)),
                    tag('p', LEGEND, 'mut')])


def _what_ran(ran: WhatRan, signals: Signals) -> str:
    values = tag('p', another_version(signals)) if signals.problem else (
        table(ran.values) if len(ran.values) > 1 else
        tag('p', 'All gains and values are those of the shipped models and presets.'))
    files = ', '.join(download(name, text) for name, text in ran.files.items())
    return ''.join([
        tag('h2', 'What was run'), pairs(ran.rows),
        f'<p>To repeat it, in the folder of the bag, with {files} beside it:</p>',
        lines('\n'.join(ran.commands)),
        details('Values that differ from the shipped ones', values, is_open=len(ran.values) < 12),
        *(details(name, lines(text)) for name, text in ran.files.items()
          if name.endswith('.yaml'))])


def another_version(signals: Signals) -> str:
    """Return a remark on signals whose configuration another version wrote."""
    return ('Another version recorded this bag: its signals are as recorded, values of its '
            f'configuration cannot be read here ({signals.problem})')


def _events(events: list[Event]) -> str:
    """Return the table of what the devices did; one line if there is nothing."""
    if not events:
        return tag('h2', 'Events') + tag('p', 'No condition warned or tripped, no state changed.')
    return tag('h2', 'Events') + table(event_rows(events), [own.t_s for own in events[:MOST]])


def _energy(accounts: Accounts | None) -> str:
    """Return the table of oil and energy; nothing for a bag without diagnostics."""
    if accounts is None:
        return ''
    parts = parts_table(accounts)
    return ''.join([
        tag('h2', 'Oil and energy'), table(energy_table(accounts)),
        tag('p', _flowing(energy_legend(accounts)), 'mut'),
        *([table(parts), tag('p', _flowing(PARTS_LEGEND), 'mut')] if parts else [])])


def _flowing(text: str) -> str:
    """Return the lines of a text as one, since the page breaks its lines itself."""
    return ' '.join(text.split('\n'))


def _picture(name: str, figure: Figure) -> str:
    """Return a figure as a picture within the page."""
    return tag('h2', 'Figure of the paper') + picture(name, image(figure, 'png'))
