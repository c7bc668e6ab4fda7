"""
The continuous states of one actuator with its load copy, and one step of their integration.

They live in one record of floats (`CONTINUOUS`), so that the integrator sees the same memory as a
flat array. A step that touches pressures below the atmosphere integrates the volumes that the
chambers' oil lacks instead of pressures (C11). Energies are integrals of powers that act on
nothing: Simpson's rule over the plant steps gives them from one evaluation a step, where the
states need four.
"""

import math
from typing import Any, NamedTuple

from isa_ros.actuator.feed import conductance, FEED_STATE, pressure_rate, VARIED
from isa_ros.core.kernel import kernel, part_of_kernel
from isa_ros.loads.forces import LOAD_STATE, own_load_force
from isa_ros.loads.port import load_acceleration
from isa_ros.plant.chambers import is_of_volumes
from isa_ros.plant.energy import ENERGIES
from isa_ros.plant.plant import begin_volumes, end_volumes, PLANT_STATE, settle
from isa_ros.plant.rates import plant_rates
from isa_ros.plant.servo_valve import tare_flow
import numpy as np

TOTALS = np.dtype([
    ('impulse', 'f8'),          # integral of the sensor force, Ns | Nms
    ('supply_volume', 'f8'),    # drawn from the supply, m3
    ('return_volume', 'f8'),    # given to the return, m3
    ('energies', ENERGIES),     # by Simpson's rule over the steps, not by their stages
])
CONTINUOUS = np.dtype([
    ('plant', PLANT_STATE), ('load', LOAD_STATE), ('supply', FEED_STATE), ('totals', TOTALS)])
"""Every continuous state of an actuator and its load copy; floats only."""

STATE_SIZE = CONTINUOUS.itemsize // 8
TOTALS_AT = STATE_SIZE - TOTALS.itemsize // 8  # no rate depends on the totals, the last states
ENERGIES_AT = STATE_SIZE - ENERGIES.itemsize // 8
COPIES = 2  # the state and a stage of its integration
STAGES = 4
NOTHING = 1e-100  # any unit: smaller states are set to zero, since denormal arithmetic is slow


class Integrated(NamedTuple):
    """What the integration of one actuator reads and writes."""

    port: Any
    """`LOAD_PORT`."""
    feed: Any
    """`SUPPLY_PORT`."""
    actuator: Any
    """`ACTUATOR`."""
    continuous: Any
    """`CONTINUOUS`: the state and a stage, (COPIES,)."""
    rates: Any
    """`CONTINUOUS`: the stages' rates of change, (STAGES,)."""
    y: Any
    """The memory of ``continuous`` as floats."""
    k: Any
    """The memory of ``rates`` as floats."""


def integrated(port: np.void, feed: np.void, actuator: np.void) -> Integrated:
    """Return it for records of one actuator, all states zero."""
    continuous, rates = scratch()
    return Integrated(port, feed, actuator, continuous, rates, flat(continuous), flat(rates))


def scratch(n: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Return the memory of ``n`` actuators: `COPIES` rows of states, `STAGES` of rates each."""
    return np.zeros(n * COPIES, CONTINUOUS), np.zeros(n * STAGES, CONTINUOUS)


def flat(rows: np.ndarray) -> np.ndarray:
    """Return the same memory of `CONTINUOUS` rows as floats, shape (rows, STATE_SIZE)."""
    return rows.view(np.float64).reshape(len(rows), STATE_SIZE)


def state_name(index: int) -> str:
    """Return the dotted name of one state of `CONTINUOUS` by its place in the flat array."""
    def walk(record: np.dtype, prefix: str) -> list[str]:
        if record.names is None:
            return [prefix]
        return [name for field in record.names
                for name in walk(record[field], f'{prefix}.{field}' if prefix else field)]
    return walk(CONTINUOUS, '')[index]


@kernel
def write_rates(tau, y, drive, port, feed, actuator, of_volumes, rates, counts):
    """
    Write the derivative of a `CONTINUOUS` into ``rates``; its powers only if it ``counts``.

    ``feed`` is its `SUPPLY_PORT`: where it has an elastance, the pressure of the supply moves
    (C15), and the pilot stage is part of what is drawn at it. ``of_volumes``: within a step of
    volumes, between `begin_volumes` and `end_volumes`.
    """
    p_s, p_t = y.supply.pressure, port.return_pressure
    force, q_p, q_t = plant_rates(
        y.plant, y.load.position, y.load.velocity, drive, p_s, p_t, actuator.plant, of_volumes,
        rates.plant, counts, rates.totals.energies, feed.elastance * feed.share)
    rates.supply.pressure = 0.0
    if feed.elastance > 0.0:
        tare = tare_flow(p_s, p_t, actuator.plant.valve)
        q_p += tare
        q_t += tare
        rates.supply.pressure = pressure_rate(tau, p_s - port.supply_pressure, q_p, feed)
        if counts:
            rates.totals.energies.leakage += tare * (p_s - p_t)
            rates.totals.energies.drawn = p_s * q_p
    own = own_load_force(y.load, port.x0, actuator.load, rates.load)
    rates.load.position = y.load.velocity
    rates.load.velocity = load_acceleration(
        tau, y.load.position, y.load.velocity, force + own, port)
    rates.totals.impulse = force
    rates.totals.supply_volume = q_p
    rates.totals.return_volume = q_t


@kernel
def simpson(k, n):
    """
    Return the weight of value ``k`` of ``n`` + 1 at equal distances, over that distance.

    Simpson's rule; if ``n`` is odd, the last three intervals by the 3/8 rule, and a single one by
    the trapezoidal rule.
    """
    if n == 1:
        return 0.5
    last = n if n % 2 == 0 else n - 3
    weight = 0.0
    if k <= last and last > 0:
        weight = 1.0 / 3.0 if k == 0 or k == last else 4.0 / 3.0 if k % 2 == 1 else 2.0 / 3.0
    if n > last and k >= last:
        weight += 3.0 / 8.0 if k == last or k == n else 9.0 / 8.0
    return weight


@kernel
def add_powers(weight, y, k):
    """Add ``weight`` (s) times the powers of the first stage to the energies."""
    for j in range(ENERGIES_AT, STATE_SIZE):
        y[0, j] += weight * k[0, j]


@part_of_kernel
def stages(h, tau, drive, of_volumes, own):
    """
    Write the four rates of a classical Runge-Kutta step of ``h`` seconds of an `Integrated`.

    One loop, so that the compiler has the plant's equations once and not four times.
    """
    port, feed, actuator, continuous, rates, y, k = own
    share = 0.0     # of the step, at which a stage is
    for stage in range(STAGES):
        write_rates(tau + share * h, continuous[min(stage, 1)], drive, port, feed, actuator,
                    of_volumes, rates[stage], stage == 0)
        share = 0.5 if stage < 2 else 1.0
        if stage < STAGES - 1:
            for j in range(TOTALS_AT):
                y[1, j] = y[0, j] + share * h * k[stage, j]


@kernel
def is_torn(h, state, rates):
    """Return whether a pressure is below the atmosphere after a step of pressures of ``h`` s."""
    k_1, k_2 = rates[0].plant.chambers, rates[1].plant.chambers
    k_3, k_4 = rates[2].plant.chambers, rates[3].plant.chambers
    return (state.p_a + h / 6.0 * (k_1.p_a + 2.0 * (k_2.p_a + k_3.p_a) + k_4.p_a) < 0.0
            or state.p_b + h / 6.0 * (k_1.p_b + 2.0 * (k_2.p_b + k_3.p_b) + k_4.p_b) < 0.0)


@part_of_kernel
def rk4_step(h, tau, drive, weight, own):
    """
    Advance the state of an `Integrated` by one classical Runge-Kutta step of ``h`` seconds.

    The powers at the beginning of the step enter the energies with ``weight``, in s. A step of
    pressures that ends below the atmosphere is repeated as one of volumes  (C11).
    """
    _, _, actuator, continuous, rates, y, k = own
    state, plant = continuous[0].plant, actuator.plant
    of_volumes = state.cushion.end != 0.0 or is_of_volumes(
        h, state.chambers, state.mechanics.position, state.mechanics.velocity, plant.chambers)
    while True:
        if of_volumes:
            begin_volumes(state, plant)
        stages(h, tau, drive, of_volumes, own)
        if of_volumes or not is_torn(h, state.chambers, rates):
            break
        of_volumes = True
    add_powers(weight, y, k)
    for j in range(ENERGIES_AT):
        value = y[0, j] + h / 6.0 * (k[0, j] + 2.0 * (k[1, j] + k[2, j]) + k[3, j])
        y[0, j] = 0.0 if abs(value) < NOTHING else value
    if of_volumes:
        end_volumes(state, plant)
    settle(state, plant)


@kernel
def end_steps(tau, weight, drive, own):
    """
    Add the powers after the last step with their ``weight``, in s; return dq/dP of the valve.

    Flow over pressure of the supply, in m3/s/Pa, between `VARIED` above and below; the flow is
    that of ``rates[0]``. 0 where the supply has no port.
    """
    port, feed, actuator, continuous, rates, y, k = own
    state, plant = continuous[0].plant, actuator.plant
    of_volumes = (is_of_volumes(0.0, state.chambers, state.mechanics.position, 0.0, plant.chambers)
                  or state.cushion.end != 0.0)
    if of_volumes:
        begin_volumes(state, plant)
    write_rates(tau, continuous[0], drive, port, feed, actuator, of_volumes, rates[0], True)
    slope = 0.0
    if feed.elastance > 0.0:
        for j in range(TOTALS_AT):
            y[1, j] = y[0, j]
        at = continuous[0].supply.pressure
        continuous[1].supply.pressure = at + VARIED
        write_rates(tau, continuous[1], drive, port, feed, actuator, of_volumes, rates[1], False)
        continuous[1].supply.pressure = at - VARIED
        write_rates(tau, continuous[1], drive, port, feed, actuator, of_volumes, rates[2], False)
        slope = conductance(rates[1].totals.supply_volume, rates[2].totals.supply_volume)
    if of_volumes:
        end_volumes(state, plant)
    add_powers(weight, y, k)
    return slope


@kernel
def rk4_steps(n, h, drive, own):
    """Take ``n`` steps of `rk4_step` under a constant drive and port."""
    for i in range(n):
        rk4_step(h, i * h, drive, h * simpson(i, n), own)
    end_steps(n * h, h * simpson(n, n), drive, own)


@kernel
def square_roots(n):
    """Take ``n`` square roots, one after the other: the yardstick of `isa bench`."""
    x = 2.0
    for _ in range(n):
        x = math.sqrt(x + 1.0)
    return x
