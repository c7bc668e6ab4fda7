"""
Figures of the paper, drawn from a run: reference dashed blue, applied solid red.

A scenario may have a figure (`figure: torque_step`), which `isa report` draws first. It shows
the knee of a leg, or the first actuator of a run without a leg.
"""

from collections.abc import Mapping
from typing import NamedTuple

from isa_ros.analysis.report.characteristics import RESPONSES
from isa_ros.analysis.report.figures import finish, stack
from isa_ros.analysis.signals.signals import Signal, Signals
from isa_ros.config.runs.run_config import ActuatorConfig, RunConfig
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError
from isa_ros.reu.wiring import Off
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

KNEE = 'kfe'
POSITION, FORCE = 'position', 'force'


class FigureLayout(NamedTuple):
    """The title and the diagrams of one figure of the paper."""

    title: str
    panels: tuple[str, ...]
    """Of `POSITION` and `FORCE`, from top to bottom."""


LAYOUTS: Mapping[str, FigureLayout] = {
    'position_torque_tracking': FigureLayout('Tracking of a trot, as Fig 12', (POSITION, FORCE)),
    'torque_step': FigureLayout('Torque step, blocked, as Fig 13', (FORCE,)),
    'force_step': FigureLayout('Force step, as Fig 14', (FORCE,)),
    'impact': FigureLayout('Impacts on the stop, as Fig 15', (FORCE, POSITION)),
    'weight': FigureLayout('Dropped weight, as Figs 17 and 18', (FORCE, POSITION)),
    'knee_sine': FigureLayout('Sine of the knee, as Fig 19', (POSITION,)),
    'leg_drop': FigureLayout('Drop of the leg, as Fig 20', (FORCE,)),
}
"""By the names of `isa_ros.scenario.figures.FIGURES`, which also has those of `RESPONSES`."""


def paper_figure(name: str, signals: Signals) -> Figure:
    """
    Return the figure of a name, drawn from a run's signals.

    Raises
    ------
    ConfigError
        The figure does not exist.

    """
    if name in RESPONSES:
        return RESPONSES[name](signals)
    if name not in LAYOUTS:
        raise ConfigError(f'{name} is not a figure; {alternatives(name, [*LAYOUTS, *RESPONSES])}')
    layout = LAYOUTS[name]
    actuator = shown(signals.run)
    rows = len(layout.panels)
    figure, axes = stack(rows, f'{layout.title}: {actuator.name}', 2.6 * rows + 0.8)
    for panel, ax in zip(layout.panels, axes):
        (draw_position if panel == POSITION else draw_force)(ax, actuator, signals)
    return finish(figure, axes)


def shown(run: RunConfig) -> ActuatorConfig:
    """Return the actuator that a figure shows: the knee of the first leg, or the first one."""
    joints = dict(run.legs[0].joints) if run.legs else {}
    return run.actuator(joints[KNEE]) if KNEE in joints else run.actuators[0]


def draw_position(ax: Axes, actuator: ActuatorConfig, signals: Signals) -> None:
    """Draw commanded and measured position of an actuator, deg or mm."""
    scale, unit = (float(np.degrees(1.0)), 'deg') if actuator.sheet.is_rotary else (1e3, 'mm')
    name = f'{actuator.name}.position'
    if not isinstance(actuator.sheet.reu.position, Off):
        _dashed(ax, signals.over_time(f'{name}_reference'), scale)
    _solid(ax, signals.over_time(name), scale, 'measured')
    ax.set_ylabel(f'position, {unit}')


def draw_force(ax: Axes, actuator: ActuatorConfig, signals: Signals) -> None:
    """Draw reference and applied force or torque of an actuator, N or Nm."""
    name = f'{actuator.name}.force'
    if not isinstance(actuator.sheet.reu.force, Off):
        _dashed(ax, signals.over_time(f'{name}_reference'), 1.0)
    _solid(ax, signals.over_time(name), 1.0, 'applied')
    ax.set_ylabel('torque, Nm' if actuator.sheet.is_rotary else 'force, N')


def _dashed(ax: Axes, signal: Signal, factor: float) -> None:
    ax.plot(signal.t, factor * signal.values, color='blue', linestyle='--', linewidth=1.1,
            label='reference')


def _solid(ax: Axes, signal: Signal, factor: float, label: str) -> None:
    ax.plot(signal.t, factor * signal.values, color='red', linewidth=1.2, label=label)
