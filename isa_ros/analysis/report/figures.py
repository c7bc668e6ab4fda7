"""Figures of a run: one for each actuator, one for the leg."""

from collections.abc import Sequence

from isa_ros.analysis.signals.traces import Trace
from isa_ros.config.run_config import ActuatorConfig, RunConfig
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

ATMOSPHERE = 101325.0  # Pa; FluidPressure is absolute, figures show gauge pressure

Traces = dict[str, Trace]


def figures(run: RunConfig, traces: Traces) -> dict[str, Figure]:
    """Return the figures of a run by name: the leg first, then every actuator."""
    drawn = {}
    if run.leg is not None:
        drawn['leg'] = leg_figure(traces)
    for actuator in run.actuators:
        drawn[actuator.name] = actuator_figure(actuator, traces)
    return drawn


def actuator_figure(actuator: ActuatorConfig, traces: Traces) -> Figure:
    """Draw position, force, chamber pressures and valve of one actuator over time."""
    figure, (position, force, pressure, valve) = stack(
        4, f'{actuator.name} ({actuator.model}, preset {actuator.preset})', 8.6)
    of = {topic: traces[f'/{actuator.name}/{topic}'] for topic in (
        'joint_states', 'references', 'pressure_a', 'pressure_b', 'valve')}
    scale, unit, load = (
        (180.0 / np.pi, 'deg', 'torque, Nm') if actuator.sheet.is_rotary
        else (1e3, 'mm', 'force, N'))
    joint, reference, spool = of['joint_states'], of['references'], of['valve']
    _reference(position, reference.t, scale * reference['position[0]'])
    _measured(position, joint.t, scale * joint['position[0]'])
    position.set_ylabel(f'position, {unit}')
    _reference(force, reference.t, reference['position[1]'])
    _measured(force, joint.t, joint['effort[0]'])
    force.set_ylabel(load)
    supply = traces['/coordinator/supply_pressure']
    for name, trace, color in (
            ('A', of['pressure_a'], 'C0'), ('B', of['pressure_b'], 'C3'),
            ('supply', supply, 'gray')):
        pressure.plot(
            trace.t, (trace['fluid_pressure'] - ATMOSPHERE) * 1e-6, label=name, color=color)
    pressure.set_ylabel('pressure, MPa gauge')
    _reference(valve, reference.t, 1e3 * reference['position[2]'])
    _measured(valve, spool.t, 1e3 * spool['position[0]'])
    valve.set_ylabel('spool, mm')
    return finish(figure, (position, force, pressure, valve))


def leg_figure(traces: Traces) -> Figure:
    """Draw joint angles, joint torques and the ground's force on the foot over time."""
    figure, (angle, torque, contact) = stack(3, 'leg', 6.6)
    joints, ground = traces['/joint_states'], traces['/coordinator/ground_contact']
    for k, name in enumerate(('HAA', 'HFE', 'KFE')):
        angle.plot(joints.t, np.degrees(joints[f'position[{k}]']), label=name)
        torque.plot(joints.t, joints[f'effort[{k}]'], label=name)
    angle.set_ylabel('joint angle, deg')
    torque.set_ylabel('joint torque, Nm')
    for axis in 'xyz':
        contact.plot(ground.t, ground[f'wrench.force.{axis}'], label=axis)
    contact.set_ylabel('ground force, N')
    return finish(figure, (angle, torque, contact))


def _reference(ax: Axes, t: np.ndarray, values: np.ndarray) -> None:
    ax.plot(t, values, color='C1', linestyle='--', linewidth=1.0, label='reference')


def _measured(ax: Axes, t: np.ndarray, values: np.ndarray) -> None:
    ax.plot(t, values, color='C0', linewidth=1.2, label='measured')


def stack(rows: int, title: str, height: float) -> tuple[Figure, tuple[Axes, ...]]:
    """Return a figure of some height, inches, with axes one above the other."""
    figure = Figure(figsize=(8.0, height), dpi=110, layout='constrained')
    figure.suptitle(title)
    return figure, tuple(figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0])


def finish(figure: Figure, axes: Sequence[Axes]) -> Figure:
    """Add grids, legends and the time axis."""
    for ax in axes:
        ax.grid(visible=True, linewidth=0.4)
        ax.legend(loc='upper right', fontsize='small')
        ax.margins(x=0.0)
    axes[-1].set_xlabel('simulation time, s')
    return figure
