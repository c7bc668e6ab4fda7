"""
A supply and all its actuators as one ODE: the reference of the supply's port (C15).

Every stage of a Runge-Kutta step evaluates all plants and the supply together, at one pressure,
in steps of 20 us; the REUs sample between steps at the same instants as in the package. Only the
equations are shared with a run: ports, mean flows, conductances and the supply's own step of
0.1 ms do not occur. Not for actuators with cavities, links, block valves or a shared body.
"""

from isa_ros.actuator.inbox import latch, merge, settle as settle_device
from isa_ros.actuator.integration import COPIES, STAGES, TOTALS_AT, write_rates
from isa_ros.actuator.kernel import run_loops
from isa_ros.actuator.rows import Memory
from isa_ros.core.kernel import called_kernel, kernel
from isa_ros.core.signals import Records
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.plant.plant import settle
from isa_ros.plant.servo_valve import tare_flow
from isa_ros.surroundings.accumulator import supply_rates
import numpy as np

_FREE = 2       # states of the supply: its pressure and the flow of its pump


@called_kernel
def rates_of_all(stage, tau, pressure, pump_flow, supply, memory):
    """Write the rates of a stage of all actuators; return (dP/dt, dQ_pump/dt) of the supply."""
    drawn = 0.0
    for n in range(len(memory.ports)):
        row = n * COPIES + (1 if stage > 0 else 0)
        state, rates = memory.continuous[row], memory.rates[n * STAGES + stage]
        actuator, port = memory.constants[n], memory.ports[n]
        state.supply.pressure = pressure
        write_rates(tau, state, memory.reu[n].amplifier, port, memory.feeds[n], actuator, False,
                    rates, False)
        drawn += rates.totals.supply_volume + tare_flow(
            pressure, port.return_pressure, actuator.plant.valve)
    rise, pump, _, _ = supply_rates(pressure, pump_flow, drawn, 0.0, supply)
    return rise, pump


@kernel
def put_stage(stage, h, memory):
    """Fill the second copy of all states: the first and ``h`` s of the rates of a stage."""
    y, k = memory.states, memory.slopes
    for n in range(len(memory.ports)):
        for j in range(TOTALS_AT):
            y[n * COPIES + 1, j] = y[n * COPIES, j] + h * k[n * STAGES + stage, j]


@kernel
def step_of_all(tau, line, supply, memory):
    """Advance all actuators and the ``line``, [P, Q_pump], by one step of 20 us."""
    h, p, q = PLANT_STEP, line[0], line[1]
    p_1, q_1 = rates_of_all(0, tau, p, q, supply, memory)
    put_stage(0, 0.5 * h, memory)
    p_2, q_2 = rates_of_all(
        1, tau + 0.5 * h, p + 0.5 * h * p_1, q + 0.5 * h * q_1, supply, memory)
    put_stage(1, 0.5 * h, memory)
    p_3, q_3 = rates_of_all(
        2, tau + 0.5 * h, p + 0.5 * h * p_2, q + 0.5 * h * q_2, supply, memory)
    put_stage(2, h, memory)
    p_4, q_4 = rates_of_all(3, tau + h, p + h * p_3, q + h * q_3, supply, memory)
    y, k = memory.states, memory.slopes
    for n in range(len(memory.ports)):
        at = n * STAGES
        for j in range(TOTALS_AT):
            y[n * COPIES, j] += h / 6.0 * (
                k[at, j] + 2.0 * (k[at + 1, j] + k[at + 2, j]) + k[at + 3, j])
        settle(memory.continuous[n * COPIES].plant, memory.constants[n].plant)
    line[0] = p + h / 6.0 * (p_1 + 2.0 * (p_2 + p_3) + p_4)
    line[1] = q + h / 6.0 * (q_1 + 2.0 * (q_2 + q_3) + q_4)


@kernel
def tick_of_all(first_step, steps, commands, line, supplies, memory):
    """Advance all by one tick with the `COMMAND` rows that take effect at its start, (n,)."""
    for n in range(len(memory.ports)):
        merge(commands[n], memory.pending[n])
        latch(memory.pending[n], memory.reu[n], memory.applied[n])
    for i in range(steps):
        for n in range(len(memory.ports)):
            state = memory.continuous[n * COPIES]
            state.supply.pressure = line[0]
            run_loops(first_step + i, state, memory.constants[n], memory.reu[n],
                      memory.channels[n], memory.thermals[n])
        step_of_all(i * PLANT_STEP, line, supplies[0], memory)
    for n in range(len(memory.ports)):
        settle_device(memory.reu[n].status, memory.applied[n])


def pressures(
        commands: Records, steps: int, start: float, supply: np.ndarray,
        memory: Memory) -> np.ndarray:
    """
    Return the pressure of the supply at each tick's end, Pa, for `COMMAND` rows (ticks, n).

    ``start`` is its pressure at t = 0, ``supply`` its `SUPPLY` record (1,), ``steps`` the plant
    steps of a tick; the actuators in ``memory`` are at rest, and are advanced.
    """
    line, found = np.zeros(_FREE), np.zeros(len(commands))
    line[0] = start
    for tick, rows in enumerate(commands):
        tick_of_all(tick * steps, steps, rows, line, supply, memory)
        found[tick] = line[0]
    return found
