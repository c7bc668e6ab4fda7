"""Groups of panels as figures for papers and slides, and the axes that all figures share."""

from collections.abc import Sequence

from isa_ros.analysis.report.marks import Marks
from isa_ros.analysis.report.panels import Group
from isa_ros.analysis.report.thinning import extreme_places
from isa_ros.run.events import TRIP
from matplotlib.axes import Axes
from matplotlib.figure import Figure

_TRIP, _OTHER = 'black', 'gray'     # no curve has them
_MOST_MARKS = 20
_PARTS = 2000       # of a curve, each drawn by its least and greatest value


def figure_of(group: Group, marks: Marks) -> Figure:
    """Draw the panels of a group one above the other, with a line at each event."""
    figure, axes = stack(len(group.panels), group.title, 1.2 + 1.85 * len(group.panels))
    for panel, ax in zip(group.panels, axes):
        for k, curve in enumerate(panel.curves):
            at = extreme_places(curve.signal.values, _PARTS)
            ax.plot(curve.signal.t[at], curve.signal.values[at] / panel.scale,
                    label=curve.label, color=f'C{k % 10}',
                    linestyle='--' if curve.is_reference else '-',
                    linewidth=1.0 if curve.is_reference else 1.2)
        ax.set_ylabel(panel.label)
    for k, ax in enumerate(axes):
        _mark(ax, marks, is_named=k == 0)
    return finish(figure, axes)


def _mark(ax: Axes, marks: Marks, *, is_named: bool) -> None:
    """Draw a line at each event; trips are named in the first axes."""
    for event in marks.events[:_MOST_MARKS]:
        is_trip = event.kind == TRIP
        ax.axvline(event.t_s, color=_TRIP if is_trip else _OTHER, linewidth=0.8, linestyle=':')
        if is_trip and is_named:
            ax.annotate(
                event.what.partition(',')[0], (event.t_s, 1.0),
                xycoords=('data', 'axes fraction'), fontsize=7, rotation=90, va='top',
                ha='right', color=_TRIP)


def stack(rows: int, title: str, height: float) -> tuple[Figure, tuple[Axes, ...]]:
    """Return a figure of some height, inches, with axes one above the other."""
    figure = Figure(figsize=(8.0, height), dpi=110, layout='constrained')
    figure.suptitle(title)
    return figure, tuple(figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0])


def finish(figure: Figure, axes: Sequence[Axes]) -> Figure:
    """Add grids, legends and the time axis."""
    for ax in axes:
        ax.grid(visible=True, linewidth=0.4)
        ax.legend(loc='center left', bbox_to_anchor=(1.0, 0.5), fontsize='small')
        ax.margins(x=0.0)
    axes[-1].set_xlabel('simulation time, s')
    return figure
