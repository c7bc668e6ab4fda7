"""An actuator at rest, at t = 0: its plant, what its sensors read, its loops and its device."""

from isa_ros.actuator.inbox import write_applied
from isa_ros.actuator.kernel import write_sample
from isa_ros.actuator.rows import Memory, row_record
from isa_ros.core.signals import HAS_ENABLE, HAS_SETPOINT
from isa_ros.plant.cushion import divide
from isa_ros.plant.plant import exact_force
from isa_ros.plant.rest_oil import rest_oil
from isa_ros.plant.sensors import sense
from isa_ros.plant.temperature_sensor import read_temperature
from isa_ros.reu.block_drive import LONG_AGO
from isa_ros.reu.cascade import initial_gains
from isa_ros.reu.wiring import Reu


def rest_plant(
        memory: Memory, position: float, force: float, supply: float, back: float) -> None:
    """
    Put the plant of one actuator at rest at ``position``, holding ``force`` (N | Nm).

    ``supply`` and ``back`` are the gauge pressures at its ports, Pa.
    """
    own, state = row_record(memory.constants), row_record(memory.continuous)
    port, thermal = row_record(memory.ports), row_record(memory.thermals)
    port.supply_pressure, port.return_pressure = supply, back
    state.supply.pressure = supply
    state.plant.mechanics.position = position
    state.load.position = position - force / own.plant.mechanics.k_s
    rest_oil(own.plant, supply, back, force, state.plant)
    divide(state.plant, own.plant)
    thermal.oil = thermal.body = own.plant.thermal.start
    reply = row_record(memory.replies)
    reply.force = exact_force(state.plant, state.load.position, state.load.velocity, own.plant)
    reply.position = position


def rest_loops(memory: Memory, sheet: Reu, mode: int, is_enabled: bool) -> None:
    """
    Let the loops of one actuator hold what its sensors read, in a mode; write its first sample.

    ``is_enabled``: it is enabled once it is initialised.
    """
    own, state = row_record(memory.constants), row_record(memory.continuous)
    reu = row_record(memory.reu)
    supply_pressure = sense(
        0, own.reu.current_steps, state.plant, state.load.position, state.load.velocity,
        row_record(memory.ports).supply_pressure, own.plant, own.noise_key,
        row_record(memory.channels), reu.measured)
    at, reu.speed.position = reu.measured, reu.measured.position
    for block, value in (
            (reu.position, at.position), (reu.force, at.force), (reu.spool, at.spool),
            (reu.pressure, at.pressure_a - at.pressure_b)):
        block.measured = value
    reu.setpoint.position = reu.protection.evidence.position = at.position
    device = reu.status
    device.flow.slow_force = at.force
    for setpoint in (reu.setpoint, device.stop):
        setpoint.stiffness, setpoint.damping = initial_gains(sheet)
    device.mode = device.acting = device.requested_mode = mode
    device.auto_enable = device.requested_enable = int(is_enabled)
    rules = own.reu.rules
    device.is_energised = int(rules.opening > 0.0 and (
        is_enabled and rules.initialisation == 0.0 or not rules.closes_when_off))
    device.is_open = int(rules.opening == 0.0 or device.is_energised == 1)
    device.switched, state.plant.block.lift = LONG_AGO, float(device.is_energised)
    sample = row_record(memory.samples)
    write_sample(state.plant, reu, sample)
    sample.supply_pressure = supply_pressure
    thermal = row_record(memory.thermals)
    sample.temperature = thermal.sensed = read_temperature(
        0, thermal.oil, own.noise_key, own.plant.sensors.temperature, thermal.sensed)
    memory.observed[:] = memory.samples
    write_applied(HAS_SETPOINT | HAS_ENABLE, reu, row_record(memory.applied))
