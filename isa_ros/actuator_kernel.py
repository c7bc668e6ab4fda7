"""
One tick of one actuator: the REU's instants and the plant's steps in time order.

Composes plant, REU and load copy into one kernel. The continuous states live in one record
of floats (`BODY`), so that the integrator sees the same memory as a flat array.
"""

from isa_ros.kernel import kernel
from isa_ros.load.port import load_acceleration, LOAD_STATE, load_stop_force, LOAD_STOPS
from isa_ros.plant.plant import PLANT, plant_rates, PLANT_STATE, stop_spool
from isa_ros.plant.sensors import convert, encode
from isa_ros.reu.cascade import cascade_step, REU, REU_STATE
from isa_ros.timebase import FORCE_WINDOWS, PLANT_STEP
import numpy as np

TOTALS = np.dtype([
    ('impulse', 'f8'),          # integral of the sensor force, Ns | Nms
    ('supply_volume', 'f8'),    # drawn from the supply, m3
    ('return_volume', 'f8'),    # given to the return, m3
])
BODY = np.dtype([('plant', PLANT_STATE), ('load', LOAD_STATE), ('totals', TOTALS)])
"""Every continuous state of an actuator and its load copy; floats only."""

STATE_SIZE = BODY.itemsize // 8
STAGES = 4

ACTUATOR = np.dtype([('plant', PLANT), ('reu', REU), ('stops', LOAD_STOPS)])
"""Every constant of one actuator, SI."""


def scratch() -> tuple[np.recarray, np.recarray]:
    """Return the working memory of one actuator: two `BODY` rows and `STAGES` rate rows."""
    return (np.zeros(2, BODY).view(np.recarray), np.zeros(STAGES, BODY).view(np.recarray))


def flat(rows: np.ndarray) -> np.ndarray:
    """Return the same memory of `BODY` rows as floats, shape (rows, STATE_SIZE)."""
    return np.asarray(rows).view(np.float64).reshape(len(rows), STATE_SIZE)


@kernel
def body_rates(tau, y, current_reference, port, actuator, rates):
    """Write the derivative of one `BODY` into ``rates``; return the sensor force."""
    force, q_p, q_t = plant_rates(
        y.plant, y.load.position, y.load.velocity, current_reference,
        port.supply_pressure, port.return_pressure, actuator.plant, rates.plant)
    stop = load_stop_force(y.load.position, y.load.velocity, actuator.stops)
    rates.load.position = y.load.velocity
    rates.load.velocity = load_acceleration(
        tau, y.load.position, y.load.velocity, force + stop, port)
    rates.totals.impulse = force
    rates.totals.supply_volume = q_p
    rates.totals.return_volume = q_t
    return force


@kernel
def body_step(tau, current_reference, port, actuator, bodies, rates, y, k):
    """
    Advance ``bodies[0]`` by one classical Runge-Kutta step; return the force at its start.

    ``bodies[1]`` holds the stage; ``y`` and ``k`` are the flat views of ``bodies``, ``rates``.
    """
    h = PLANT_STEP
    force = body_rates(tau, bodies[0], current_reference, port, actuator, rates[0])
    for j in range(STATE_SIZE):
        y[1, j] = y[0, j] + 0.5 * h * k[0, j]
    body_rates(tau + 0.5 * h, bodies[1], current_reference, port, actuator, rates[1])
    for j in range(STATE_SIZE):
        y[1, j] = y[0, j] + 0.5 * h * k[1, j]
    body_rates(tau + 0.5 * h, bodies[1], current_reference, port, actuator, rates[2])
    for j in range(STATE_SIZE):
        y[1, j] = y[0, j] + h * k[2, j]
    body_rates(tau + h, bodies[1], current_reference, port, actuator, rates[3])
    for j in range(STATE_SIZE):
        y[0, j] += h / 6.0 * (k[0, j] + 2.0 * (k[1, j] + k[2, j]) + k[3, j])
    stop_spool(bodies[0].plant, actuator.plant)
    return force


@kernel
def measure(force, plant, sensors, measured):
    """Write what the sensors give at one instant into ``measured``  (S1, S2)."""
    measured.position = encode(plant.mechanics.position, sensors.encoder)
    measured.force = convert(
        force, -sensors.force_range, sensors.force_range, sensors.force_step)
    measured.pressure_a = convert(
        plant.chambers.p_a, 0.0, sensors.pressure_range, sensors.pressure_step)
    measured.pressure_b = convert(
        plant.chambers.p_b, 0.0, sensors.pressure_range, sensors.pressure_step)
    measured.spool = convert(
        plant.valve.spool, -sensors.spool_range, sensors.spool_range, sensors.spool_step)
    measured.current = convert(
        plant.coil.current, -sensors.current_range, sensors.current_range, sensors.current_step)


@kernel
def write_sample(measured, plant, reu, sample):
    """Fill one `SAMPLE` from what the sensors read and the loops hold."""
    sample.position = measured.position
    sample.velocity = reu.position.velocity
    sample.force = measured.force
    sample.pressure_a = measured.pressure_a
    sample.pressure_b = measured.pressure_b
    sample.spool = measured.spool
    sample.spool_velocity = plant.valve.velocity
    sample.current = measured.current
    sample.position_reference = reu.setpoint.position
    sample.force_reference = reu.position.force_reference
    sample.spool_reference = reu.spool_reference
    sample.current_reference = reu.current_reference


@kernel
def actuator_tick(
        first_step, window_steps, port, actuator, bodies, rates, y, k,
        reu_state, read_out, reply, sample):
    """
    Advance one actuator by ``FORCE_WINDOWS * window_steps`` plant steps from ``first_step``.

    Fills the `LOAD_REPLY` and the `SAMPLE` at the end of the tick. ``port`` is constant over
    the tick; ``read_out`` is a `MEASURED` row for the end of the tick's reading.
    """
    reu = actuator.reu
    body = bodies[0]
    steps = 0
    body.totals.supply_volume = 0.0
    body.totals.return_volume = 0.0
    for window in range(FORCE_WINDOWS):
        body.totals.impulse = 0.0
        for _ in range(window_steps):
            step = first_step + steps
            tau = steps * PLANT_STEP
            if (step - reu.offset_steps) % reu.current_steps == 0:
                force = body_rates(
                    tau, body, reu_state.current_reference, port, actuator, rates[0])
                measure(force, body.plant, actuator.plant.sensors, reu_state.measured)
                cascade_step(step, reu, reu_state)
            body_step(
                tau, reu_state.current_reference, port, actuator, bodies, rates, y, k)
            steps += 1
        reply.mean_forces[window] = body.totals.impulse / (window_steps * PLANT_STEP)
    end_force = body_rates(
        steps * PLANT_STEP, body, reu_state.current_reference, port, actuator, rates[0])
    reply.force = end_force
    reply.position = body.plant.mechanics.position
    reply.velocity = body.plant.mechanics.velocity
    reply.supply_volume = body.totals.supply_volume
    reply.return_volume = body.totals.return_volume
    measure(end_force, body.plant, actuator.plant.sensors, read_out)
    write_sample(read_out, body.plant, reu_state, sample)
