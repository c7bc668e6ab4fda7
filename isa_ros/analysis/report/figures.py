"""Figures of a run: one for each leg, each actuator and each circuit."""

from collections.abc import Sequence

from isa_ros.analysis.signals.signals import Signal, Signals
from isa_ros.config.runs.body_config import BODY
from isa_ros.config.runs.leg_config import LegConfig
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.config.runs.supplies import GAS, SupplyConfig
from isa_ros.config.text.names import parted
from isa_ros.core.units import MPA
from isa_ros.plant.hose import LumpedHoses
from isa_ros.run.events import Event, TRIP
from isa_ros.surroundings.circuits.sheet import CircuitSupply
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np


_TRIP = 'black'     # no curve has it
_MOST_MARKS = 20
_PRESSURE, _BACK = 'pressure, MPa gauge', 'return side, MPa gauge'
_GAS = 'temperature of gas, celsius'
_OF_LEG = ('position', 'torque', 'foot_force')


def figures(signals: Signals, events: Sequence[Event] = ()) -> dict[str, Figure]:
    """
    Return the figures of a run by name: the legs first, then every actuator, then every circuit.

    What was not recorded is left out. A line at each trip of an actuator among ``events`` is drawn
    in its figure.
    """
    drawn = {}
    for leg in signals.run.legs:
        if {f'{leg.name}.{name}' for name in _OF_LEG} <= set(signals):
            drawn[leg.kind if leg.name == BODY else leg.name] = leg_figure(leg, signals)
    for actuator in signals.run.actuators:
        drawn[actuator.name] = actuator_figure(actuator, signals)
        _mark(drawn[actuator.name], [
            own for own in events if (own.kind, own.source) == (TRIP, actuator.name)])
    for supply in signals.run.supplies:
        if circuit_signals(supply, signals):
            drawn[supply.name] = circuit_figure(supply, signals)
    return drawn


def _mark(figure: Figure, trips: Sequence[Event]) -> None:
    """Draw a line at each trip through all axes of a figure, with its condition in the first."""
    for k, ax in enumerate(figure.axes):
        for trip in trips[:_MOST_MARKS]:
            ax.axvline(trip.t_s, color=_TRIP, linewidth=0.8, linestyle=':')
            if k == 0:
                ax.annotate(
                    trip.what.partition(',')[0], (trip.t_s, 1.0),
                    xycoords=('data', 'axes fraction'), fontsize=7, rotation=90, va='top',
                    ha='right', color=_TRIP)


def actuator_figure(actuator: ActuatorConfig, signals: Signals) -> Figure:
    """Draw position, force, chamber pressures and valve of one actuator over time."""
    figure, (position, force, pressure, valve) = stack(
        4, f'{actuator.name} ({actuator.model}, preset {actuator.preset})', 8.6)
    scale, unit, load = (
        (180.0 / np.pi, 'deg', 'torque, Nm') if actuator.sheet.is_rotary
        else (1e3, 'mm', 'force, N'))

    def of(field: str) -> Signal:
        return signals.drawn(f'{actuator.name}.{field}')

    for ax, field, factor, label in (
            (position, 'position', scale, f'position, {unit}'), (force, 'force', 1.0, load),
            (valve, 'spool', 1e3, 'spool, mm')):
        _reference(ax, of(f'{field}_reference'), factor)
        _measured(ax, of(field), factor)
        ax.set_ylabel(label)
    # the sensors are in the valve block, at the ends of the hoses
    at = 'hose ' if isinstance(actuator.sheet.plant.hoses, LumpedHoses) else ''
    for name, signal, color in (
            (f'{at}A', of('pressure_a'), 'C2'), (f'{at}B', of('pressure_b'), 'C4'),
            ('supply', signals.drawn(signals.supply_of(actuator.name)), 'gray')):
        pressure.plot(signal.t, signal.values / MPA, label=name, color=color)
    cushion = of('cushion_pressure')
    if cushion.values.any():
        is_in = np.where(cushion.values == 0.0, np.nan, cushion.values)
        pressure.plot(cushion.t, is_in / MPA, label='cushion', color='C3')
    pressure.set_ylabel(_PRESSURE)
    return finish(figure, (position, force, pressure, valve))


def circuit_signals(supply: SupplyConfig, signals: Signals) -> dict[str, Signal]:
    """Return the recorded pressures and gas temperatures of the parts of a circuit by name."""
    names = [f'{own.name}.{field}' for own in supply.sampled[1:] for field in own.published]
    return {name: signals.over_time(name) for name in names if name in signals}


def circuit_figure(supply: SupplyConfig, signals: Signals) -> Figure:
    """
    Draw the pressures of a circuit's manifolds, and the temperatures of its accumulators.

    The return side, whose pressures are a hundredth of the others, has axes of its own.
    """
    found = circuit_signals(supply, signals)
    sheet = supply.sheet
    back = sheet.with_return() if isinstance(sheet, CircuitSupply) else frozenset()
    groups: dict[str, list[str]] = {}
    for name in found:
        groups.setdefault(_GAS if name.endswith(GAS) else _BACK if part_of(name) in back
                          else _PRESSURE, []).append(name)
    figure, axes = stack(len(groups), f'{supply.name} (circuit)', 2.0 + 2.2 * len(groups))
    for ax, label in zip(axes, (own for own in (_PRESSURE, _BACK, _GAS) if own in groups)):
        for name in groups[label]:
            values = found[name].values / (1.0 if label == _GAS else MPA)
            ax.plot(found[name].t, values, label=part_of(name), linewidth=1.0)
        ax.set_ylabel(label)
    return finish(figure, axes)


def part_of(name: str) -> str:
    """Return the part of a circuit that a signal belongs to."""
    return parted(name.rpartition('.')[0])[1]


def leg_figure(leg: LegConfig, signals: Signals) -> Figure:
    """Draw joint angles, joint torques and the ground's force on the foot over time."""
    figure, (angle, torque, contact) = stack(3, leg.called.removeprefix('the '), 6.6)
    angles, torques, ground = (
        signals.over_time(f'{leg.name}.{name}') for name in _OF_LEG)
    for k, name in enumerate(('HAA', 'HFE', 'KFE')):
        angle.plot(angles.t, np.degrees(angles.values[:, k]), label=name)
        torque.plot(torques.t, torques.values[:, k], label=name)
    angle.set_ylabel('joint angle, deg')
    torque.set_ylabel('joint torque, Nm')
    for k, axis in enumerate('xyz'):
        contact.plot(ground.t, ground.values[:, k], label=axis)
    contact.set_ylabel('ground force, N')
    return finish(figure, (angle, torque, contact))


def _reference(ax: Axes, signal: Signal, factor: float) -> None:
    ax.plot(signal.t, factor * signal.values, color='C1', linestyle='--', linewidth=1.0,
            label='reference')


def _measured(ax: Axes, signal: Signal, factor: float) -> None:
    ax.plot(signal.t, factor * signal.values, color='C0', linewidth=1.2, label='measured')


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
