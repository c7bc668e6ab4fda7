"""
Figures of the paper, drawn from a bag: reference dashed blue, applied solid red.

A scenario may have a figure (`figure: torque_step`), which `isa report` draws first. It shows
the knee of a leg, or the first actuator of a run without a leg.
"""

from collections.abc import Mapping
from typing import NamedTuple

from isa_ros.analysis.report.characteristics import RESPONSES
from isa_ros.analysis.report.figures import finish, stack, Traces
from isa_ros.analysis.signals.traces import Trace
from isa_ros.config.run_config import ActuatorConfig, RunConfig
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError
from isa_ros.reu.wiring import Off
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

KNEE = 'kfe'
POSITION, FORCE = 'position', 'force'


class Layout(NamedTuple):
    """The title and the diagrams of one figure of the paper."""

    title: str
    panels: tuple[str, ...]
    """Of `POSITION` and `FORCE`, from top to bottom."""


LAYOUTS: Mapping[str, Layout] = {
    'position_torque_tracking': Layout('Tracking of a trot, as Fig 12', (POSITION, FORCE)),
    'torque_step': Layout('Torque step, blocked, as Fig 13', (FORCE,)),
    'force_step': Layout('Force step, as Fig 14', (FORCE,)),
    'impact': Layout('Impacts on the stop, as Fig 15', (FORCE, POSITION)),
    'weight': Layout('Dropped weight, as Figs 17 and 18', (FORCE, POSITION)),
    'knee_sine': Layout('Sine of the knee, as Fig 19', (POSITION,)),
    'leg_drop': Layout('Drop of the leg, as Fig 20', (FORCE,)),
}
"""By the names of `isa_ros.scenario.scenario.FIGURES`, which also has those of `RESPONSES`."""


def paper_figure(name: str, run: RunConfig, traces: Traces) -> Figure:
    """
    Return the figure of a name, drawn from a run's traces.

    Raises
    ------
    ConfigError
        The figure does not exist.

    """
    if name in RESPONSES:
        return RESPONSES[name](run, traces)
    if name not in LAYOUTS:
        raise ConfigError(f'{name} is not a figure; {alternatives(name, [*LAYOUTS, *RESPONSES])}')
    layout = LAYOUTS[name]
    actuator = shown(run)
    rows = len(layout.panels)
    figure, axes = stack(rows, f'{layout.title}: {actuator.name}', 2.6 * rows + 0.8)
    for panel, ax in zip(layout.panels, axes):
        (draw_position if panel == POSITION else draw_force)(ax, actuator, traces)
    return finish(figure, axes)


def shown(run: RunConfig) -> ActuatorConfig:
    """Return the actuator that a figure shows: the knee, or the first one."""
    joints = dict(run.leg.joints) if run.leg is not None else {}
    return run.actuator(joints[KNEE]) if KNEE in joints else run.actuators[0]


def draw_position(ax: Axes, actuator: ActuatorConfig, traces: Traces) -> None:
    """Draw commanded and measured position of an actuator, deg or mm."""
    scale, unit = (float(np.degrees(1.0)), 'deg') if actuator.sheet.is_rotary else (1e3, 'mm')
    joint, reference = _of(actuator, traces)
    if not isinstance(actuator.sheet.reu.position, Off):
        _dashed(ax, reference.t, scale * reference['position[0]'])
    _solid(ax, joint.t, scale * joint['position[0]'], 'measured')
    ax.set_ylabel(f'position, {unit}')


def draw_force(ax: Axes, actuator: ActuatorConfig, traces: Traces) -> None:
    """Draw reference and applied force or torque of an actuator, N or Nm."""
    joint, reference = _of(actuator, traces)
    if not isinstance(actuator.sheet.reu.force, Off):
        _dashed(ax, reference.t, reference['position[1]'])
    _solid(ax, joint.t, joint['effort[0]'], 'applied')
    ax.set_ylabel('torque, Nm' if actuator.sheet.is_rotary else 'force, N')


def _of(actuator: ActuatorConfig, traces: Traces) -> tuple[Trace, Trace]:
    return (traces[f'/{actuator.name}/joint_states'], traces[f'/{actuator.name}/references'])


def _dashed(ax: Axes, t: np.ndarray, values: np.ndarray) -> None:
    ax.plot(t, values, color='blue', linestyle='--', linewidth=1.1, label='reference')


def _solid(ax: Axes, t: np.ndarray, values: np.ndarray, label: str) -> None:
    ax.plot(t, values, color='red', linewidth=1.2, label=label)
