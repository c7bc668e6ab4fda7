"""
Drive one actuator's setpoint by an array, and log its exact states, in compiled code.

The same loops and plant as in a tick (`actuator_kernel.loops_and_plant`), without the tick:
every `PERIOD_NS` one value of the array becomes the setpoint's position or effort, with a
velocity where a position moves, and one `TRACE` row is written. The load is the actuator's own.
"""

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.kernel import first_broken, loops_and_plant, state_name
from isa_ros.core.kernel import kernel
from isa_ros.core.timebase import NS_PER_SECOND, PLANT_STEP_NS, steps_in
from isa_ros.errors import SimulationDiverged
from isa_ros.plant.coil import coil_current
from isa_ros.plant.plant import read_sensors
from isa_ros.reu.cascade import OFF
import numpy as np

PERIOD_NS = 100_000   # that of the converters and of the current loop
RATE_HZ = NS_PER_SECOND / PERIOD_NS
_STEPS = steps_in(PERIOD_NS, 'period of the trace')

TRACE = np.dtype([
    ('position_reference', 'f8'),   # m | rad
    ('force_reference', 'f8'),      # N | Nm
    ('pressure_reference', 'f8'),   # of the difference, Pa
    ('spool_reference', 'f8'),      # m
    ('current_reference', 'f8'),    # amplifier A
    ('drive', 'f8'),                # to the amplifier: V with an explicit coil, else A
    ('position', 'f8'), ('force', 'f8'), ('pressure', 'f8'), ('spool', 'f8'), ('current', 'f8'),
    ('position_measured', 'f8'), ('force_measured', 'f8'),
    ('velocity', 'f8'),             # exact, m/s | rad/s
    ('pressure_a', 'f8'), ('pressure_b', 'f8'),     # Pa gauge
])
"""One instant: exact states, what the sensors gave then, and the references made from that."""


@kernel
def write_states(body, plant, read_out, row):
    """Write the states of one instant, and what the sensors gave in ``read_out``."""
    row.position = body.plant.mechanics.position
    row.velocity = body.plant.mechanics.velocity
    row.pressure = body.plant.chambers.p_a - body.plant.chambers.p_b
    row.pressure_a = body.plant.chambers.p_a
    row.pressure_b = body.plant.chambers.p_b
    row.spool = body.plant.valve.spool
    row.current = coil_current(body.plant.coil, plant.coil)
    row.position_measured = read_out.position
    row.force_measured = read_out.force


@kernel
def write_references(reu, state, row):
    """Write the references of one instant; 0 for a block that is off."""
    row.position_reference = state.setpoint.position
    row.force_reference = state.force_reference
    if reu.pressure_kind == OFF:
        row.pressure_reference = 0.0
    elif reu.force_kind != OFF:
        row.pressure_reference = state.force.output
    elif reu.position_kind != OFF:
        row.pressure_reference = state.position.output
    else:
        row.pressure_reference = state.setpoint.effort
    row.spool_reference = state.spool_reference
    row.current_reference = state.current_reference
    row.drive = state.drive


@kernel
def excite_steps(
        first_step, steps, is_position, values, velocities, trace, ports, actuators, bodies,
        rates, y, k, reu_states, read_outs):
    """
    Run ``steps`` plant steps for each of ``values``; return the rows without a broken state.

    ``trace`` has as many rows as ``values``. States are read before the loops run at the
    instant, references after it: error and reference of one row belong together.
    """
    port, actuator, body = ports[0], actuators[0], bodies[0]
    reu_state, read_out = reu_states[0], read_outs[0]
    for row in range(len(values)):
        if is_position:
            reu_state.setpoint.position = values[row]
            reu_state.setpoint.velocity = velocities[row]
        else:
            reu_state.setpoint.effort = values[row]
        trace[row].force = read_sensors(
            body.plant, body.load.position, body.load.velocity, actuator.plant, read_out)
        write_states(body, actuator.plant, read_out, trace[row])
        step = first_step + row * steps
        loops_and_plant(step, 0.0, port, actuator, bodies, rates, y, k, reu_state)
        write_references(actuator.reu, reu_state, trace[row])
        for i in range(1, steps):
            loops_and_plant(step + i, 0.0, port, actuator, bodies, rates, y, k, reu_state)
        if first_broken(y) >= 0:
            return row
    return len(values)


def excite(
        actuator: SmartActuator, quantity: str, values: np.ndarray,
        velocities: np.ndarray | None = None) -> np.ndarray:
    """
    Advance by `PERIOD_NS` for each of ``values``; return the `TRACE`, shape (n,).

    ``quantity`` is ``position`` or ``effort``; ``velocities`` go with positions, None: all
    zero. Setpoints the actuator accepted but did not tick since do not take effect here. It
    must have a load of its own.

    Raises
    ------
    SimulationDiverged
        A state is no longer finite.

    """
    trace = np.zeros(len(values), TRACE)
    memory = actuator.memory
    done = excite_steps(
        actuator.t_ns // PLANT_STEP_NS, _STEPS, quantity == 'position',
        np.ascontiguousarray(values, dtype=float),
        np.zeros(len(values)) if velocities is None else np.ascontiguousarray(velocities),
        trace, memory.ports, memory.constants, memory.bodies, memory.rates, memory.states,
        memory.slopes, memory.reu, memory.read_outs)
    actuator.t_ns += min(done + 1, len(values)) * PERIOD_NS
    if done < len(values):
        broken = first_broken(memory.states)
        raise SimulationDiverged(
            actuator.t_ns, f'{actuator.name}: {state_name(broken)}', memory.states[0, broken])
    return trace
