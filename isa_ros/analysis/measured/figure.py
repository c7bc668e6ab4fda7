"""The figure of `isa against`: every measured signal with the simulated ones over it."""

from isa_ros.analysis.measured.against import Against, unit_of
from matplotlib.figure import Figure

ROW = 1.9       # inch
_LINES = (('measured', 'black', 1.4), ('simulated', 'C0', 1.0), ('simulated, closed', 'C1', 1.0))


def overlay(found: Against) -> Figure:
    """Return a row of axes for each signal, over one axis of time."""
    names = list(found.simulated)
    figure = Figure(figsize=(9.0, 0.8 + ROW * len(names)), dpi=110, layout='constrained')
    figure.suptitle(f'{found.name}: simulated against measured')
    axes = figure.subplots(len(names), 1, squeeze=False, sharex=True)[:, 0]
    for ax, name in zip(axes, names):
        for (label, colour, width), signals in zip(
                _LINES, (found.measured, found.simulated, found.improved)):
            if name in signals:
                ax.plot(signals[name].t, signals[name].values, color=colour, linewidth=width,
                        label=label)
        ax.set_ylabel(f'{name}, {unit_of(name, found.is_rotary)}', fontsize='small')
        ax.grid(visible=True, linewidth=0.4)
    axes[0].legend(loc='upper right', fontsize='small')
    axes[-1].set_xlabel('time, s')
    return figure
