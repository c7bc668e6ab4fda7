"""
The moving pressure of a supply inside an actuator's tick  (C15, C16, E1).

Without others (N = 0) the pressure is that of a linear equation, whatever the actuator does; with
them C15 integrates to the volume drawn.
"""

from dataclasses import replace
from functools import cache
import math

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.feed import conductance
from isa_ros.actuator.rows import Memory
from isa_ros.actuator.timing import Timing
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY, SUPPLY_PORT, SUPPLY_REPLY
from isa_ros.plant import chambers, servo_valve
from isa_ros.surroundings.supply import Supply
from isa_ros.surroundings.supply_port import MovingPort, SupplyPorts
import numba
import numpy as np
import pytest
from tests.sheets import FINE, setpoint, smart_actuator
from tests.surroundings.supplied import SHEET

MS = 1_000_000
TICK = Timing(step_ns=MS, controller_offset_ns=120_000)
T = 1e-3                    # s, a tick
PRESSURE, BACK = 19e6, 1e6  # Pa; not those that an actuator begins with
E = 5e12                    # Pa/m3, of 0.2 l at 1 GPa


def actuator_of(timing: Timing = TICK) -> SmartActuator:
    """Return an actuator that is to move a mass."""
    actuator = smart_actuator('isa_v5', 'mass', timing=timing)
    if numba.config.DISABLE_JIT:    # else rows have attributes in kernels only
        actuator.memory = Memory(*(with_attributes(rows) for rows in actuator.memory))
        actuator._commands = with_attributes(actuator._commands)
        actuator._incoming = with_attributes(actuator._incoming)
    actuator.accept(setpoint(position=0.08, velocity=0.3))
    return actuator


def with_attributes(rows: np.ndarray) -> np.ndarray:
    """Return the same memory, in which a row has its fields as attributes."""
    return rows.view(np.recarray) if rows.dtype.names else rows


def port_of(pressure: float = PRESSURE) -> np.void:
    """Return the `LOAD_PORT` of one tick."""
    port = np.zeros(1, LOAD_PORT)[0]
    port['supply_pressure'], port['return_pressure'] = pressure, BACK
    return port


@cache
def opened(timing: Timing) -> tuple[SmartActuator, bytes]:
    """Return an actuator whose valve has opened for 4 ms, and its state."""
    actuator = actuator_of(timing)
    for _ in range(4 * MS // timing.step_ns):
        actuator.tick(port_of(PRESSURE + 1e6))
    return actuator, actuator.snapshot()


def ticked(timing: Timing = TICK, ticks: int = 1, **feed: float) -> SmartActuator:
    """Return it after another tick, or some, with a `SUPPLY_PORT` of these values."""
    actuator, state = opened(timing)
    actuator.restore(state)
    actuator.memory.feeds.fill(0)
    for name, value in feed.items():
        actuator.memory.feeds[name] = value
    for _ in range(ticks):
        actuator.tick(port_of())
    return actuator


def pressure_of(actuator: SmartActuator) -> float:
    """Return the pressure of the supply as the actuator has integrated it, Pa."""
    return float(actuator._body.supply.pressure)


@pytest.mark.parametrize('sign', [1.0, -1.0])
def test_without_others_the_pressure_is_that_of_a_linear_equation(sign: float) -> None:
    """
    C15 with N = 0: r' = E (q + q' t - r/R), r = 0 at the tick's start.

    RK4 errs by (E h/R)^5/120 = 8e-13 of r a step, with E/R = 500 1/s.
    """
    inflow, trend, slope = sign * 1e-4, sign * 0.2, 1e-10
    a = E * slope
    risen = E / a * ((inflow - trend / a) * -math.expm1(-a * T) + trend * T)
    actuator = ticked(elastance=E, inflow=inflow, trend=trend, slope=slope)
    assert abs(risen) > 0.5e6
    assert pressure_of(actuator) - PRESSURE == pytest.approx(risen, rel=1e-9, abs=0.0)
    assert float(actuator.sample.supply_pressure) == pressure_of(actuator)
    # its last conversion is up to 0.1 ms before the tick's end
    assert float(actuator._reu.supply_pressure) == pytest.approx(
        pressure_of(actuator), rel=0.0, abs=0.2 * abs(risen))


def test_with_others_the_pressure_falls_by_all_that_they_draw() -> None:
    """C15 with 1/R = 0: P - P_0 = E (q_in T - N (V - q_last T)), by the same stages."""
    actuator = ticked(elastance=E, inflow=2e-4, share=3.0, flow=5e-5)
    volume = float(actuator.reply.supply_volume)
    risen = E * (2e-4 * T - 3.0 * (volume - 5e-5 * T))
    assert abs(3.0 * E * volume) > 0.2e6
    assert pressure_of(actuator) - PRESSURE == pytest.approx(risen, rel=1e-9, abs=0.0)


def test_a_very_large_supply_is_one_that_holds_its_pressure() -> None:
    """V9, E1, E2: oil and energy, with the pilot stage, are those of a held pressure."""
    held = ticked(ticks=2)
    held_sample, held_reply = held.sample.copy(), held.reply.copy()
    large = ticked(ticks=2, elastance=1e-3, share=1.0)
    for name in ('supply_volume', 'return_volume', 'force'):
        assert large.reply[name] == pytest.approx(held_reply[name], rel=1e-9, abs=0.0), name
    for name in ('hydraulic_energy', 'leakage_energy', 'throttling_energy', 'power'):
        # Simpson's rule over the powers, RK4 over the volumes
        assert large.sample[name] == pytest.approx(held_sample[name], rel=1e-6, abs=0.0), name


def test_the_account_closes_while_the_pressure_moves() -> None:
    """E1 = E2 to E6: powers by Simpson's rule over 50 steps, states by RK4, below 1e-6 here."""
    before = ticked(ticks=0).sample.copy()
    after = ticked(elastance=E, inflow=2e-4, share=3.0).sample
    names = ('leakage', 'throttling', 'cross_port', 'relief', 'friction', 'damping', 'stored')
    gone = after.work - before.work + sum(
        float(after[f'{name}_energy'] - before[f'{name}_energy']) for name in names)
    assert gone == pytest.approx(
        float(after.hydraulic_energy - before.hydraulic_energy), rel=1e-6, abs=0.0)


def test_oil_is_paid_at_the_pressure_while_it_is_drawn() -> None:
    """
    E1: the integral of P Q, with a pressure that rises by 1 MPa in a tick of 0.1 ms.

    The mean of both pressures times the volume errs by at most 1/12 of what both change, P by 5 %
    and Q by less than 10 %: 5e-4. At the pressure of the tick's start it were 2.5 % less.
    """
    actuator = ticked(FINE, elastance=E, inflow=2e-3)
    reply, paid = actuator.reply, float(actuator.memory.fed['paid'][0])
    mean = 0.5 * (PRESSURE + pressure_of(actuator))
    assert pressure_of(actuator) - PRESSURE == pytest.approx(1e6, rel=1e-9)
    assert paid == pytest.approx(mean * float(reply.supply_volume), rel=5e-4, abs=0.0)
    assert float(actuator.sample.power) * 1e-4 == pytest.approx(
        paid - BACK * float(reply.return_volume), rel=1e-12, abs=0.0)


def drawn(actuator: SmartActuator, pressure: float, per_s: float) -> float:
    """Return the flow of a valve at its state, of the equations V5 to V9 and V18, in m3/s."""
    plant, own = actuator._constants.plant, actuator._body.plant
    oil, p_a, p_b = own.chambers, float(own.chambers.p_a), float(own.chambers.p_b)
    per_a, per_b = chambers.elastances(own.mechanics.position, plant.chambers)
    assert min(oil.p_a, oil.p_b) > 0.0
    opened_lands, _ = servo_valve.conductances(own.spool.position, plant.valve)
    roots = servo_valve.root_drops(
        opened_lands, p_a, p_b, pressure, BACK, per_a + per_s, per_b + per_s, plant.valve)
    return float(servo_valve.metered(opened_lands, roots)[2]
                 + servo_valve.tare_flow(pressure, BACK, plant.valve))


def test_an_answer_has_flow_and_conductance_of_the_valve_at_the_end() -> None:
    """
    C16: over 0.3 MPa above and below; lands are smoothed for N E (V18).

    The same equations, apart from roundings, which a difference of flows has ten times.
    """
    hard = 1e15     # Pa/m3, a millilitre
    actuator = ticked(elastance=hard, inflow=2e-4, share=3.0)
    answer, p = actuator.memory.fed[0], pressure_of(actuator)
    flow, above, below = (drawn(actuator, p + more, 3.0 * hard) for more in (0.0, 3e5, -3e5))
    assert float(answer['flow']) == pytest.approx(flow, rel=1e-12, abs=0.0)
    assert float(answer['conductance']) == pytest.approx((above - below) / 6e5, rel=1e-9, abs=0.0)
    for other in (0.0, hard):
        assert abs(drawn(actuator, p, other) - flow) > 1e-6 * flow, 'the others show'


def test_no_valve_draws_less_at_a_higher_pressure() -> None:
    """C16: a conductance of rounding errors is none."""
    assert conductance(5e-5, 2e-5) == pytest.approx(5e-11, rel=1e-12, abs=0.0)
    assert conductance(2e-5, 5e-5) == 0.0


def test_equal_actuators_and_their_supply_agree_about_its_pressure() -> None:
    """
    C15, C16: three that do the same are what each assumes; the supply integrates for itself.

    What is left is the lag of the pump, whose flow the port lets rise evenly: T/(3 lag) = 1.1 % of
    E q' T^2/2 = 1.4e13 0.0065 1e-6/2 Pa, 0.5 kPa.
    """
    line = {'precharge_mpa': 60.0, 'line_volume_l': 0.05}    # no gas at these pressures
    supply = Supply(replace(SHEET, port=MovingPort(), **line), MS, 1e-12, rows=(0, 1, 2))
    actuators = [actuator_of() for _ in range(3)]
    ports = SupplyPorts(3, [supply])
    feeds, replies, fed = (np.zeros(3, of) for of in (SUPPLY_PORT, LOAD_REPLY, SUPPLY_REPLY))
    for own in actuators:
        own.restore(opened(TICK)[1])
    for tick in range(4):
        before = supply.pressure
        ports.fill(feeds)
        for k, own in enumerate(actuators):
            own.memory.feeds[0] = feeds[k]
            own.tick(port_of(before))
            replies[k], fed[k] = own.reply, own.memory.fed[0]
        assert ports.take(fed)
        supply.advance(float(np.sum(replies['supply_volume'])), 0.0, float(np.sum(fed['paid'])))
        assert before - supply.pressure > 0.5e6
        if tick > 0:    # at first the pump stands, and its set point is the pressure
            assert pressure_of(actuators[0]) == pytest.approx(supply.pressure, rel=0.0, abs=600.0)
