"""
The oracle of the load port: leg, ground and three actuators as one ODE, no exchange.

Every Runge-Kutta stage evaluates all plants and the leg together; the REUs sample between
steps at the same instants as in the package. Only the equations are shared with the
package; ports, mean forces, ticks and the leg's own step do not occur here.
"""

from isa_ros.actuator.kernel import ACTUATOR, BODY, STATE_SIZE
from isa_ros.actuator.sheet import actuator_record
from isa_ros.core.contact import normal_force
from isa_ros.core.kernel import kernel
from isa_ros.core.timebase import PLANT_STEP, PLANT_STEP_NS
from isa_ros.plant.plant import plant_rates, read_sensors
from isa_ros.plant.spool import stop_spool
from isa_ros.reu.cascade import cascade_step, is_due, REU_STATE
from isa_ros.surroundings.leg.dynamics import leg_terms
from isa_ros.surroundings.leg.motion import leg_rates, N_STATES, shifted
from isa_ros.surroundings.leg.sheet import leg_records
from isa_ros.surroundings.linkage import actuator_coordinate
import numpy as np

TRACE = np.dtype([
    ('force', '<f8', (3,)),     # sensor forces at the end of the interval, N | Nm
    ('mean', '<f8', (3,)),      # their means over the interval
    ('leg', '<f8', (N_STATES,)),      # the leg's continuous states
    ('normal', '<f8'),          # ground force, N
    ('work', '<f8', (3,)),      # done by the sensors on the leg since t = 0, J
])
"""One row per interval of the recording."""
ROW_NS = 100_000  # that interval: the smallest window of the tests
TIME_BYTES = 8  # a snapshot begins with the time
IMPULSE = STATE_SIZE - 3  # its place in a flat `BODY`


@kernel
def system_rates(bodies, y, references, pressures, actuators, is_held, body, linkages, ground,
                 rates):
    """Write the plants' rates; return those of the leg and of the three works."""
    f0, f1, f2 = 0.0, 0.0, 0.0
    p0, p1, p2 = 0.0, 0.0, 0.0
    for j in range(3):
        x, r, _ = actuator_coordinate(y[j + 1], linkages[j])
        v = r * y[j + 5]
        force, _, _ = plant_rates(bodies[j].plant, x, v, references[j], pressures[0],
                                  pressures[1], actuators[j].plant, rates[j].plant)
        bodies[j].load.position, bodies[j].load.velocity = x, v
        rates[j].totals.impulse = force
        if j == 0:
            f0, p0 = force, force * v
        elif j == 1:
            f1, p1 = force, force * v
        else:
            f2, p2 = force, force * v
    return leg_rates(y, (f0, f1, f2), is_held, body, linkages, ground), (p0, p1, p2)


@kernel
def stage(flat, flat_rates, k, h):
    """Fill the stage row of the plants: y + h * rates k."""
    for j in range(3):
        for i in range(STATE_SIZE):
            flat[1, j, i] = flat[0, j, i] + h * flat_rates[k, j, i]


@kernel
def system_step(h, bodies, flat, rates, flat_rates, y, w, references, pressures, actuators,
                is_held, body, linkages, ground):
    """Advance everything by one classical Runge-Kutta step; return the leg's y and the works."""
    common = (references, pressures, actuators, is_held, body, linkages, ground)
    k1, p1 = system_rates(bodies[0], y, *common, rates[0])
    stage(flat, flat_rates, 0, 0.5 * h)
    k2, p2 = system_rates(bodies[1], shifted(y, 0.5 * h, k1), *common, rates[1])
    stage(flat, flat_rates, 1, 0.5 * h)
    k3, p3 = system_rates(bodies[1], shifted(y, 0.5 * h, k2), *common, rates[2])
    stage(flat, flat_rates, 2, h)
    k4, p4 = system_rates(bodies[1], shifted(y, h, k3), *common, rates[3])
    for j in range(3):
        for i in range(STATE_SIZE):
            flat[0, j, i] += h / 6.0 * (
                flat_rates[0, j, i] + 2.0 * (flat_rates[1, j, i] + flat_rates[2, j, i])
                + flat_rates[3, j, i])
        stop_spool(bodies[0][j].plant.valve, actuators[j].plant.valve.x_max)
    y = shifted(shifted(shifted(shifted(y, h / 6.0, k1), h / 3.0, k2), h / 3.0, k3), h / 6.0, k4)
    w = (w[0] + h / 6.0 * (p1[0] + 2.0 * (p2[0] + p3[0]) + p4[0]),
         w[1] + h / 6.0 * (p1[1] + 2.0 * (p2[1] + p3[1]) + p4[1]),
         w[2] + h / 6.0 * (p1[2] + 2.0 * (p2[2] + p3[2]) + p4[2]))
    return y, w


@kernel
def run(n_rows, steps_per_row, command_steps, release_step, commands, y0, pressures, bodies, flat,
        rates, flat_rates, actuators, reus, body_rows, linkages, ground_rows, references, trace):
    """Fill ``trace``; ``commands`` (n, 3, 5) take effect every ``command_steps`` plant steps."""
    body, ground = body_rows[0], ground_rows[0]
    y, w = y0, (0.0, 0.0, 0.0)
    for row in range(n_rows):
        for j in range(3):
            bodies[0][j].totals.impulse = 0.0
        for i in range(steps_per_row):
            step = row * steps_per_row + i
            for j in range(3):
                x, r, _ = actuator_coordinate(y[j + 1], linkages[j])
                reu = actuators[j].reu
                if step % command_steps == 0:
                    c = commands[step // command_steps, j]
                    setpoint = reus[j].setpoint
                    setpoint.position, setpoint.velocity, setpoint.effort = c[0], c[1], c[2]
                    setpoint.stiffness, setpoint.damping = c[3], c[4]
                if is_due(step, reu.current_steps, reu.offset_steps):
                    read_sensors(bodies[0][j].plant, x, r * y[j + 5], actuators[j].plant,
                                 reus[j].measured)
                    cascade_step(step, reu, reus[j])
                if is_due(step, reu.current_steps, reu.offset_steps + reu.delay_steps):
                    reus[j].amplifier = reus[j].drive
                references[j] = reus[j].amplifier
            y, w = system_step(PLANT_STEP, bodies, flat, rates, flat_rates, y, w, references,
                               pressures, actuators, step < release_step, body, linkages, ground)
        m = leg_terms(y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], body)
        trace[row].normal = normal_force(m.foot_z, m.foot_v_z, ground)
        system_rates(bodies[0], y, references, pressures, actuators, False, body, linkages,
                     ground, rates[0])
        for j in range(3):
            trace[row].mean[j] = bodies[0][j].totals.impulse / (steps_per_row * PLANT_STEP)
            trace[row].force[j] = flat_rates[0, j, IMPULSE]
            trace[row].work[j] = w[j]
        for i in range(N_STATES):
            trace[row].leg[i] = y[i]


def monolith(rig, actuators, leg, commands, n_rows, release_ns, aside):
    """
    Run the one ODE from the states of the three `SmartActuator` and the `Leg` at t = 0.

    Pistons and rotor start ``aside`` (m | rad). Returns the `TRACE`, shape (n_rows,).
    """
    bodies, rates = np.zeros((2, 3), BODY), np.zeros((4, 3), BODY)
    constants, reus = np.zeros(3, ACTUATOR), np.zeros(3, REU_STATE)
    offset_steps = rig.controller_offset_ns // PLANT_STEP_NS
    for j, (actuator, sheet) in enumerate(zip(actuators, rig.sheets)):
        snapshot = actuator.snapshot()
        bodies[0, j] = np.frombuffer(snapshot, BODY, 1, TIME_BYTES)[0]
        reus[j] = np.frombuffer(snapshot, REU_STATE, 1, TIME_BYTES + BODY.itemsize)[0]
        constants[j] = actuator_record(sheet, offset_steps)[0]
    bodies['plant']['mechanics']['position'][0] += aside
    trace = np.zeros(n_rows, TRACE)
    y0 = tuple(np.frombuffer(leg.snapshot(), np.float64, N_STATES, TIME_BYTES).tolist())
    run(n_rows, ROW_NS // PLANT_STEP_NS, rig.command_ns // PLANT_STEP_NS,
        release_ns // PLANT_STEP_NS, commands, y0, np.array([rig.supply_pressure, 0.0]), bodies,
        bodies.view(np.float64).reshape(2, 3, STATE_SIZE), rates,
        rates.view(np.float64).reshape(4, 3, STATE_SIZE), constants, reus, *leg_records(rig.leg),
        np.zeros(3), trace)
    return trace
