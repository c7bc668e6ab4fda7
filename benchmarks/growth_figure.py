"""Figure of speed and memory over the number of actuators."""

from collections.abc import Mapping, Sequence
from statistics import median

from isa_ros.bench.memory import MIB, total
from isa_ros.bench.spec import Measured
from matplotlib.axes import Axes
from matplotlib.figure import Figure

Curve = Sequence[tuple[int, Sequence[Measured]]]
"""(number of actuators, runs), ascending."""

REAL_TIME = 1000.0      # ticks/s
SPEEDS = (20, 50, 100, 200, 500, 1000, 2000, 5000, 10000)     # labels of the axis, ticks/s
_STYLES = ('C0o-', 'C1s-')


def growth_figure(curves: Mapping[str, Curve]) -> Figure:
    """Draw ticks/s and memory, one line for each way of running."""
    figure = Figure(figsize=(8.0, 3.6), dpi=110, layout='constrained')
    speed, memory = figure.subplots(1, 2)
    for (name, curve), style in zip(curves.items(), _STYLES):
        numbers = [n for n, _ in curve]
        speed.loglog(numbers, [median(run.ticks_per_s for run in runs) for _, runs in curve],
                     style, markersize=4, label=name)
        memory.plot(numbers, [median(map(total, runs)) / MIB for _, runs in curve],
                    style, markersize=4, label=name)
    speed.axhline(REAL_TIME, color='gray', linestyle='--', linewidth=0.8, label='real time')
    lowest, highest = speed.get_ylim()
    shown = [value for value in SPEEDS if lowest <= value <= highest]
    speed.set_yticks(shown, [str(value) for value in shown])
    for ax, label in ((speed, 'ticks of 1 ms per second'), (memory, 'memory together, MiB')):
        _finish(ax, label, max(curves.values(), key=len))
    return figure


def _finish(ax: Axes, label: str, curve: Curve) -> None:
    numbers = [n for n, _ in curve]
    ax.set_xticks(numbers, [str(n) for n in numbers])
    ax.minorticks_off()
    ax.set_xlabel('actuators, recording')
    ax.set_ylabel(label)
    ax.grid(visible=True, linewidth=0.4)
    ax.legend(fontsize='small')
