"""
An actuator at rest, at t = 0: its plant, what its sensors read, its loops and its device.

Python calls these functions as they are, and a library of an actuator has them compiled.
"""

from typing import Any, NamedTuple

from isa_ros.actuator.inbox import write_applied
from isa_ros.actuator.kernel import write_sample
from isa_ros.actuator.rows import Memory
from isa_ros.core.kernel import kernel_function
from isa_ros.core.record import row_record
from isa_ros.core.signals import HAS_ENABLE, HAS_SETPOINT
from isa_ros.plant.cushion import divide
from isa_ros.plant.plant import exact_force
from isa_ros.plant.rest_oil import rest_oil
from isa_ros.plant.sensors import sense
from isa_ros.plant.temperature_sensor import read_temperature
from isa_ros.reu.block_drive import LONG_AGO


class RestRows(NamedTuple):
    """The rows of an actuator that `rest` reads and fills."""

    own: Any
    """`ACTUATOR`."""
    state: Any
    """`CONTINUOUS`."""
    port: Any
    """`LOAD_PORT` in force."""
    thermal: Any
    """`THERMAL_STATE`."""
    reu: Any
    """`REU_STATE`."""
    channels: Any
    """`CHANNELS_STATE`."""
    sample: Any
    """`SAMPLE`."""
    reply: Any
    """`LOAD_REPLY`."""
    applied: Any
    """`COMMAND` in force."""


def put_at_rest(
        memory: Memory, start: tuple[float, float, float, float], gains: tuple[float, float],
        mode: int, is_enabled: bool) -> None:
    """Put an actuator whose state is zero at rest, as `rest`."""
    rest(RestRows(*map(row_record, (
        memory.constants, memory.continuous, memory.ports, memory.thermals, memory.reu,
        memory.channels, memory.samples, memory.replies, memory.applied))),
        start, gains, mode, is_enabled)
    memory.observed[:] = memory.samples


@kernel_function
def rest(rows: RestRows, start: Any, gains: Any, mode: int, is_enabled: bool) -> None:
    """
    Put an actuator whose state is zero at rest; its loops hold what its sensors read.

    ``start`` are the numbers of a `START`: position (m | rad), the force that it holds (N | Nm),
    and the gauge pressures of supply and return, Pa. ``gains`` are stiffness and damping of its
    impedance before the first setpoint. ``is_enabled``: it is enabled once it is initialised.
    """
    own, state, port, thermal = rows.own, rows.state, rows.port, rows.thermal
    rest_plant(own, start, state, port, thermal, rows.reply)
    supply_pressure = rest_loops(
        own, state, port, rows.reu, rows.channels, gains, mode, is_enabled)
    first_sample(own, state, rows.reu, thermal, supply_pressure, rows.sample)
    write_applied(HAS_SETPOINT | HAS_ENABLE, rows.reu, rows.applied)


@kernel_function
def rest_plant(own: Any, start: Any, state: Any, port: Any, thermal: Any, reply: Any) -> None:
    """Put the plant of an `ACTUATOR` at rest, and its `LOAD_REPLY`."""
    position, force, supply, back = start
    port.supply_pressure, port.return_pressure = supply, back
    state.supply.pressure = supply
    state.plant.mechanics.position = position
    state.load.position = position - force / own.plant.mechanics.k_s
    rest_oil(own.plant, supply, back, force, state.plant)
    divide(state.plant, own.plant)
    thermal.oil = thermal.body = own.plant.thermal.start
    reply.force = exact_force(state.plant, state.load.position, state.load.velocity, own.plant)
    reply.position = position


@kernel_function
def rest_loops(
        own: Any, state: Any, port: Any, reu: Any, channels: Any, gains: tuple[float, float],
        mode: int, is_enabled: bool) -> float:
    """
    Let the loops of an `ACTUATOR` hold what its sensors read, in a mode.

    Return the pressure of the supply that they read, Pa.
    """
    supply_pressure: float = sense(
        0, own.reu.current_steps, state.plant, state.load.position, state.load.velocity,
        port.supply_pressure, own.plant, own.noise_key, channels, reu.measured)
    at = reu.measured
    reu.speed.position = at.position
    reu.position.measured, reu.force.measured = at.position, at.force
    reu.spool.measured = at.spool
    reu.pressure.measured = at.pressure_a - at.pressure_b
    reu.setpoint.position = reu.protection.evidence.position = at.position
    device = reu.status
    device.flow.slow_force = at.force
    reu.setpoint.stiffness, reu.setpoint.damping = gains
    device.stop.stiffness, device.stop.damping = gains
    device.mode = device.acting = device.requested_mode = mode
    device.auto_enable = device.requested_enable = int(is_enabled)
    rules = own.reu.rules
    is_on_at_once = is_enabled and rules.initialisation == 0.0
    device.is_energised = int(
        rules.opening > 0.0 and (is_on_at_once or rules.closes_when_off == 0))
    device.is_open = int(rules.opening == 0.0 or device.is_energised == 1)
    device.switched = LONG_AGO
    state.plant.block.lift = float(device.is_energised)
    return supply_pressure


@kernel_function
def first_sample(
        own: Any, state: Any, reu: Any, thermal: Any, supply_pressure: float,
        sample: Any) -> None:
    """Fill the `SAMPLE` of t = 0."""
    write_sample(state.plant, reu, sample)
    sample.supply_pressure = supply_pressure
    thermal.sensed = read_temperature(
        0, thermal.oil, own.noise_key, own.plant.sensors.temperature, thermal.sensed)
    sample.temperature = thermal.sensed
