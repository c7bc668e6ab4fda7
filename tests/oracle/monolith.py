"""
The oracle of the load port: leg, ground and three actuators as one ODE, no exchange.

Every Runge-Kutta stage evaluates all plants and the leg together; the REUs sample between
steps at the same instants as in the package. Only the equations are shared with the
package; ports, mean forces, ticks and the leg's own step do not occur here.
"""

from typing import NamedTuple

from isa_ros.actuator.integration import CONTINUOUS, STATE_SIZE
from isa_ros.actuator.kernel import ACTUATOR
from isa_ros.actuator.sheet import actuator_record
from isa_ros.core.contact import normal_force
from isa_ros.core.kernel import called_kernel, kernel
from isa_ros.core.timebase import PLANT_STEP, PLANT_STEP_NS
from isa_ros.plant.channels import CHANNELS_STATE
from isa_ros.plant.rates import plant_rates
from isa_ros.plant.sensors import sense
from isa_ros.plant.spool import stop_spool
from isa_ros.reu.cascade import cascade_step, is_due, REU_STATE
from isa_ros.reu.protection import feed
from isa_ros.surroundings.bodies.leg.motion import (
    continuous, joint_angles, leg_rates, LEG_STATE, shifted, terms_of)
from isa_ros.surroundings.bodies.leg.sheet import leg_record
from isa_ros.surroundings.linkage import actuator_coordinate
import numpy as np

TRACE = np.dtype([
    ('force', '<f8', (3,)),     # sensor forces at the end of the interval, N | Nm
    ('mean', '<f8', (3,)),      # their means over the interval
    ('angle', '<f8', (3,)),     # of the joints, rad
    ('normal', '<f8'),          # ground force, N
    ('work', '<f8', (3,)),      # done by the sensors on the leg since t = 0, J
])
"""One row per interval of the recording."""
ROW_NS = 100_000  # that interval: the smallest window of the tests
TIME_BYTES = 8  # a snapshot begins with the time
STAGES = 4


class System(NamedTuple):
    """What the one ODE is integrated in."""

    bodies: np.ndarray
    """`CONTINUOUS` of the three actuators and of a stage, (2, 3)."""
    rates: np.ndarray
    """`CONTINUOUS` of the stages' rates, (STAGES, 3)."""
    states: np.ndarray
    """The same memory as ``bodies``, as floats."""
    slopes: np.ndarray
    """The same memory as ``rates``, as floats."""
    reus: np.ndarray
    """`REU_STATE`, (3,)."""
    actuators: np.ndarray
    """`ACTUATOR`, (3,)."""
    channels: np.ndarray
    """`CHANNELS_STATE`, (3,)."""
    legs: np.ndarray
    """`LEG`, (1,)."""


def floats(rows):
    """Return the same memory of `CONTINUOUS` rows (n, 3) as floats, (n, 3, STATE_SIZE)."""
    return rows.view(np.float64).reshape(len(rows), 3, STATE_SIZE)


@kernel
def load_side(y, leg):
    """Return positions and speeds of the load's side of the three sensors."""
    x_haa, r_haa, _ = actuator_coordinate(y.q_haa, leg.haa)
    x_hfe, r_hfe, _ = actuator_coordinate(y.q_hfe, leg.hfe)
    x_kfe, r_kfe, _ = actuator_coordinate(y.q_kfe, leg.kfe)
    return (x_haa, x_hfe, x_kfe), (r_haa * y.v_haa, r_hfe * y.v_hfe, r_kfe * y.v_kfe)


@called_kernel
def system_rates(bodies, y, supply_pressure, is_held, system, rates):
    """Write the plants' rates; return those of the leg and of the three works."""
    leg = system.legs[0]
    x, v = load_side(y, leg)
    for j in range(3):
        force, _, _ = plant_rates(
            bodies[j].plant, x[j], v[j], system.reus[j].amplifier, supply_pressure, 0.0,
            system.actuators[j].plant, False, rates[j].plant, False,
            rates[j].totals.energies)
        bodies[j].load.position, bodies[j].load.velocity = x[j], v[j]
        rates[j].totals.impulse = force
    f = (rates[0].totals.impulse, rates[1].totals.impulse, rates[2].totals.impulse)
    return leg_rates(y, f, is_held, leg), (f[0] * v[0], f[1] * v[1], f[2] * v[2])


@kernel
def stage(system, k, h):
    """Fill the stage row of the plants: y + h * rates k."""
    for j in range(3):
        for i in range(STATE_SIZE):
            system.states[1, j, i] = system.states[0, j, i] + h * system.slopes[k, j, i]


@kernel
def system_step(h, y, w, supply_pressure, is_held, system):
    """Advance everything by one classical Runge-Kutta step; return the leg's y and the works."""
    bodies, rates, states, k = system.bodies, system.rates, system.states, system.slopes
    k1, p1 = system_rates(bodies[0], y, supply_pressure, is_held, system, rates[0])
    stage(system, 0, 0.5 * h)
    k2, p2 = system_rates(
        bodies[1], shifted(y, 0.5 * h, k1), supply_pressure, is_held, system, rates[1])
    stage(system, 1, 0.5 * h)
    k3, p3 = system_rates(
        bodies[1], shifted(y, 0.5 * h, k2), supply_pressure, is_held, system, rates[2])
    stage(system, 2, h)
    k4, p4 = system_rates(
        bodies[1], shifted(y, h, k3), supply_pressure, is_held, system, rates[3])
    for j in range(3):
        for i in range(STATE_SIZE):
            states[0, j, i] += h / 6.0 * (
                k[0, j, i] + 2.0 * (k[1, j, i] + k[2, j, i]) + k[3, j, i])
        stop_spool(bodies[0][j].plant.spool, system.actuators[j].plant.valve.x_max)
    y = shifted(shifted(shifted(shifted(y, h / 6.0, k1), h / 3.0, k2), h / 3.0, k3), h / 6.0, k4)
    w = (w[0] + h / 6.0 * (p1[0] + 2.0 * (p2[0] + p3[0]) + p4[0]),
         w[1] + h / 6.0 * (p1[1] + 2.0 * (p2[1] + p3[1]) + p4[1]),
         w[2] + h / 6.0 * (p1[2] + 2.0 * (p2[2] + p3[2]) + p4[2]))
    return y, w


@kernel
def sample_reus(step, y, commands, is_commanded, system):
    """Run what is due of the three REUs at plant step ``step``; ``commands`` are (3, 5)."""
    x, v = load_side(y, system.legs[0])
    for j in range(3):
        actuator, state = system.actuators[j], system.reus[j]
        reu = actuator.reu
        if is_commanded:
            c, setpoint = commands[j], state.setpoint
            setpoint.position, setpoint.velocity, setpoint.effort = c[0], c[1], c[2]
            setpoint.stiffness, setpoint.damping = c[3], c[4]
            feed(state.protection)
        if is_due(step, reu.current_steps, reu.offset_steps):
            sense(step, reu.current_steps, system.bodies[0][j].plant, x[j], v[j], 0.0,
                  actuator.plant, actuator.noise_key, system.channels[j], state.measured)
            cascade_step(step, reu, state)
        if is_due(step, reu.current_steps, reu.offset_steps + reu.delay_steps):
            state.amplifier = state.drive


@kernel
def run(steps_per_row, command_steps, release_step, commands, y, supply_pressure, system, trace):
    """Fill ``trace``; ``commands`` (n, 3, 5) take effect every ``command_steps`` plant steps."""
    leg, bodies, rates = system.legs[0], system.bodies[0], system.rates[0]
    w = (0.0, 0.0, 0.0)
    for row in range(len(trace)):
        for j in range(3):
            bodies[j].totals.impulse = 0.0
        for step in range(row * steps_per_row, (row + 1) * steps_per_row):
            sample_reus(
                step, y, commands[step // command_steps], step % command_steps == 0, system)
            y, w = system_step(PLANT_STEP, y, w, supply_pressure, step < release_step, system)
        m = terms_of(y, leg)
        trace[row].normal = normal_force(m.foot_z, m.foot_v_z, leg.ground)
        system_rates(bodies, y, supply_pressure, False, system, rates)
        angles = joint_angles(y)
        for j in range(3):
            trace[row].mean[j] = bodies[j].totals.impulse / (steps_per_row * PLANT_STEP)
            trace[row].force[j] = rates[j].totals.impulse
            trace[row].work[j] = w[j]
            trace[row].angle[j] = angles[j]


def monolith(rig, actuators, leg, commands, n_rows, release_ns, aside):
    """
    Run the one ODE from the states of the three `SmartActuator` and the `Leg` at t = 0.

    Pistons and rotor start ``aside`` (m | rad). Returns the `TRACE`, shape (n_rows,).
    """
    bodies, rates = np.zeros((2, 3), CONTINUOUS), np.zeros((STAGES, 3), CONTINUOUS)
    constants, reus = np.zeros(3, ACTUATOR), np.zeros(3, REU_STATE)
    offset_steps = rig.controller_offset_ns // PLANT_STEP_NS
    for j, (actuator, sheet) in enumerate(zip(actuators, rig.sheets)):
        snapshot = actuator.snapshot()
        bodies[0, j] = np.frombuffer(snapshot, CONTINUOUS, 1, TIME_BYTES)[0]
        reus[j] = np.frombuffer(snapshot, REU_STATE, 1, TIME_BYTES + CONTINUOUS.itemsize)[0]
        constants[j] = actuator_record(sheet, offset_steps)[0]
    bodies['plant']['mechanics']['position'][0] += aside
    trace = np.zeros(n_rows, TRACE)
    y = continuous(np.frombuffer(leg.snapshot(), LEG_STATE, 1, TIME_BYTES)[0])
    run(ROW_NS // PLANT_STEP_NS, rig.command_ns // PLANT_STEP_NS, release_ns // PLANT_STEP_NS,
        commands, y, rig.supply_pressure, System(
            bodies=bodies, rates=rates, states=floats(bodies), slopes=floats(rates), reus=reus,
            actuators=constants, channels=np.zeros(3, CHANNELS_STATE),
            legs=leg_record(rig.leg)), trace)
    return trace
