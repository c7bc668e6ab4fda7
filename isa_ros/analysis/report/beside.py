"""Two runs over each other on one page: the differences of their configurations, then both."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from isa_ros.analysis.report.document import document, Shown
from isa_ros.analysis.report.figures import figure_of
from isa_ros.analysis.report.files import refuse_foreign, write_files
from isa_ros.analysis.report.groups import groups_of
from isa_ros.analysis.report.key_figures import key_rows, landing_rows, LEGEND
from isa_ros.analysis.report.marks import Marks, marks_of
from isa_ros.analysis.report.panels import Curve, Group, Panel
from isa_ros.analysis.report.report import Recorded, span_of, verdict_list
from isa_ros.replay.comparison import Comparison, THINNED
from isa_ros.text.markup import details, pairs, table, tag
from isa_ros.text.table import digits
import numpy as np

Pair = tuple[Recorded, Recorded]
"""The expected run, then the actual one."""


def write_comparison(comparison: Comparison, runs: Pair, page: Path) -> list[Path]:
    """
    Write the page of two runs and its figures; return their paths, the page first.

    Raises
    ------
    BagError
        The page or a figure would replace another file.

    """
    names = names_of(runs)
    shown = list(_shown(runs, names))
    refuse_foreign(page, [own.group.name for own in shown])
    head = _differences(comparison, names) + ''.join(map(_of_run, runs, names))
    text = document(f'{names[0]} and {names[1]}', head, shown,
                    span_of([own.signals for own in runs]))
    return write_files(page, text, {own.group.name: figure_of(*own) for own in shown})


def names_of(runs: Pair) -> tuple[str, str]:
    """Return how the runs are called: as their bags, unless both have one name."""
    expected, actual = (own.name for own in runs)
    return (expected, actual) if expected != actual else ('expected', 'actual')


def _differences(comparison: Comparison, names: tuple[str, str]) -> str:
    """Return the markup of what differs: keys, then messages by topic."""
    return ''.join([
        tag('h2', 'Differences'), tag('p', comparison.key_remark),
        table(comparison.key_rows(*names)), tag('p', THINNED) if comparison.is_thinned else '',
        tag('p', str(comparison.report)),
        details('Messages that differ, by topic', table(comparison.topic_rows(*names)))])


def _of_run(run: Recorded, name: str) -> str:
    """Return the markup of one of the runs: verdict, key figures, what ran."""
    return ''.join([
        tag('h2', name), verdict_list(run.verdict), table(landing_rows(run.signals)),
        table(key_rows(run.signals)), tag('p', LEGEND, 'mut'),
        details('What was run', pairs(run.ran.rows))])


def _shown(runs: Pair, names: tuple[str, str]) -> Iterator[Shown]:
    """Yield the groups of both runs, those of one name over each other."""
    found: dict[str, list[Group | None]] = {}
    for k, run in enumerate(runs):
        for group in groups_of(run.signals):
            found.setdefault(group.name, [None, None])[k] = group
    for name, (expected, actual) in found.items():
        yield Shown(over_each_other(name, (expected, actual), names), _marks(
            (expected, actual), runs, names))


def _marks(groups: Sequence[Group | None], runs: Pair, names: tuple[str, str]) -> Marks:
    """Return the marks of a group in both runs, with the names of the runs in front."""
    both = Marks([], [])
    for group, run, name in zip(groups, runs, names):
        own = marks_of(group.sources if group else (), run.bands, run.events)
        both = Marks(
            [*both.bands, *(band._replace(source=f'{name} {band.source}') for band in own.bands)],
            [*both.events, *(event._replace(source=f'{name} {event.source}')
                             for event in own.events)])
    return both


def over_each_other(
        name: str, groups: tuple[Group | None, Group | None], names: tuple[str, str]) -> Group:
    """Return the group of two runs, each panel with the curves of both."""
    panels: dict[str, list[Panel | None]] = {}
    for k, group in enumerate(groups):
        for panel in _numbered(group.panels if group else ()):
            panels.setdefault(panel.title, [None, None])[k] = panel
    one = groups[0] or groups[1]
    assert one is not None
    return Group(name, one.title, [
        _panel([(own, run) for own, run in zip(pair, names) if own]) for pair in panels.values()],
        one.sources)


def _numbered(panels: Sequence[Panel]) -> Iterator[Panel]:
    """Yield panels with their unit and, among those of one title, their place in the title."""
    counts: dict[str, int] = {}
    for panel in panels:
        counts[panel.label] = counts.get(panel.label, 0) + 1
        n = counts[panel.label]
        yield replace(panel, title=panel.title if n == 1 else f'{panel.title} ({n})')


def _panel(panels: Sequence[tuple[Panel, str]]) -> Panel:
    """Return one panel with the curves of all, named by their run."""
    first = panels[0][0]
    curves = [replace(own, label=f'{run}: {own.label}') for panel, run in panels
              for own in panel.curves]
    caption = 'In one of the runs only.' if len(panels) == 1 else ' '.join(
        _apart(one, other, first) for one, other in zip(panels[0][0].curves, panels[1][0].curves)
        if one.label == other.label)
    return replace(first, curves=curves, caption=caption)


def _apart(one: Curve, other: Curve, panel: Panel) -> str:
    """Return how far two curves are apart, at the times of both."""
    t, first, second = np.intersect1d(one.signal.t, other.signal.t, return_indices=True)
    gap = other.signal.values[second] - one.signal.values[first]
    known = ~np.isnan(gap)
    if not known.any():
        return f'{one.label}: no sample at the same time.'
    t, gap = t[known], gap[known] / panel.scale
    k = int(np.argmax(np.abs(gap)))
    if gap[k] == 0.0:
        return f'{one.label}: equal.'
    rms, most = digits(float(np.sqrt(np.mean(gap * gap))), 3), digits(float(abs(gap[k])), 3)
    return f'{one.label}: apart by {rms} {panel.unit} rms, at most {most}, at t = {t[k]:.3f} s.'
