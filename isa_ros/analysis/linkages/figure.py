"""A figure of the linkages of a run: each in three poses, and its lever arm over the stroke."""

from collections.abc import Sequence

from isa_ros.analysis.linkages.drives import CHILD, DrawnDrive, PARENT, ROD
from isa_ros.core.units import MILLI
from matplotlib.axes import Axes
from matplotlib.figure import Figure

_COLOURS = {PARENT: 'black', CHILD: 'C0', ROD: 'C1'}
_STRENGTHS = (0.25, 1.0, 0.5)       # of the lower end, the start and the upper end
_MOST_NAMES = 4
ROW = 2.6       # inch


def linkage_figure(drives: Sequence[DrawnDrive], title: str) -> Figure:
    """Return a row of axes for each drive."""
    figure = Figure(figsize=(9.0, 0.6 + ROW * len(drives)), dpi=110, layout='constrained')
    figure.suptitle(title)
    rows = figure.subplots(len(drives), 2, squeeze=False, width_ratios=(1.0, 1.3))
    for (left, right), drive in zip(rows, drives):
        _linkage(left, drive)
        _lever(right, drive)
    return figure


def _linkage(ax: Axes, drive: DrawnDrive) -> None:
    for lines, strength in zip(drive.poses, _STRENGTHS):
        for line in lines:
            x, y = line.points.T / MILLI
            ax.plot(x, y, color=_COLOURS[line.part], alpha=strength, marker='o', markersize=3,
                    linewidth=2.5 if line.part == ROD else 1.2)
    ax.plot(0.0, 0.0, marker='+', color='black', markersize=9)
    ax.set_aspect('equal', adjustable='datalim')
    names = ', '.join(drive.names[:_MOST_NAMES])
    more = '' if len(drive.names) <= _MOST_NAMES else f' and {len(drive.names) - _MOST_NAMES} more'
    ax.set_title(f'{names}{more}: {drive.kind}', fontsize='small')
    ax.set_xlabel('mm', fontsize='small')
    ax.tick_params(labelsize='x-small')


def _lever(ax: Axes, drive: DrawnDrive) -> None:
    reach = drive.reach
    is_length = reach.turns and not drive.is_rotary
    ax.plot(reach.positions / drive.scale, reach.levers / (MILLI if is_length else 1.0),
            color='C0')
    for end in (0.0, drive.stroke):
        ax.axvline(end / drive.scale, color='gray', linestyle='--', linewidth=0.8)
    ax.axvline(drive.position / drive.scale, color='C1', linewidth=0.8)
    ax.grid(visible=True, linewidth=0.4)
    ax.set_ylabel(f'lever, {"mm" if is_length else "1"}', fontsize='small')
    ax.set_xlabel(f'position, {drive.unit}; dashed: stroke; orange: start', fontsize='small')
    low, high = (end / reach.scale for end in (reach.coordinates[0], reach.coordinates[-1]))
    ax.set_title(f'{reach.joint} from {low:.4g} to {high:.4g} {reach.unit}', fontsize='small')
    ax.tick_params(labelsize='x-small')
