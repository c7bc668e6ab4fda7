"""Poppets in the service lines: their lift, their flow in series with the lands, their energy."""

from dataclasses import replace
import math

from hypothesis import given, strategies as st
from isa_ros.core.parameter import defaults
from isa_ros.core.record import row_record, rows_of
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.plant.block_valve import (
    block_record, blocked_line, drive_block, line_pressure, poppet_conductance, PoppetBlock,
    root_slope, time_to_open)
from isa_ros.plant.energy import no_powers
from isa_ros.plant.plant import plant_record, PLANT_STATE
from isa_ros.plant.rates import plant_rates
from isa_ros.plant.servo_valve import conductances, signed_sqrt, smoothing
import pytest
from scipy.optimize import brentq
from tests.sheets import actuator_sheet

SUPPLY, BACK = 20.7e6, 0.5e6
PRESSURE = st.floats(-0.1e6, 24e6)
K = st.just(0.0) | st.floats(1e-15, 1e-6)    # m3/s/sqrt(Pa)
SHEET = defaults(PoppetBlock)


def blocked_plant(model='isa_v5', **values):
    """Return the `PLANT` record of a model with block valves."""
    sheet = replace(actuator_sheet(model).plant, block_valve=replace(SHEET, **values))
    return row_record(plant_record(sheet))


def test_an_open_poppet_has_the_rated_flow_at_the_rated_drop_and_a_closed_one_its_leakage():
    """V21: 30 l/min at 0.7 MPa; 2.5e-4 l/min at 21 MPa."""
    block = block_record(SHEET)
    assert poppet_conductance(1.0, block) * math.sqrt(0.7e6) == pytest.approx(
        30e-3 / 60.0, rel=1e-12, abs=0.0)
    assert poppet_conductance(0.0, block) * math.sqrt(21e6) == pytest.approx(
        2.5e-7 / 60.0, rel=1e-12, abs=0.0)
    assert poppet_conductance(0.5, block) == pytest.approx(
        0.5 * (block.k_open + block.k_closed), rel=1e-12, abs=0.0)


def test_the_lift_begins_after_the_delay_and_takes_the_declared_times():
    """V21: 2 ms and 5 ms down, 2 ms and 10 ms up; it ends at seat and stop exactly."""
    own = PoppetBlock(
        closes='when_off', rated_lpm=30.0, rated_drop_mpa=0.7, leakage_lpm=0.0, delay_ms=2.0,
        opening_ms=10.0, closing_ms=5.0)
    block = block_record(own)
    assert time_to_open(own) == pytest.approx(0.012, rel=1e-12, abs=0.0)

    def after(seconds, is_energised, lift):
        for k in range(round(seconds / PLANT_STEP)):
            drive_block(is_energised, k * PLANT_STEP, lift, block)
            lift += PLANT_STEP * block.slew
        return lift
    assert after(2e-3, 0, 1.0) == 1.0
    assert after(4.5e-3, 0, 1.0) == pytest.approx(0.5, abs=1e-9)
    assert after(8e-3, 0, 1.0) == pytest.approx(0.0, abs=1e-12)
    assert after(7e-3, 1, 0.0) == pytest.approx(0.5, abs=1e-9)
    assert after(13e-3, 1, 0.0) == pytest.approx(1.0, abs=1e-12)
    block.is_stuck = 1.0
    assert after(13e-3, 0, 0.7) == 0.7


@given(k_s=K, k_t=K, k_b=K, p_s=PRESSURE, p_t=PRESSURE, p=PRESSURE,
       delta=st.sampled_from([1e3, 1e5, 3e6]))
def test_the_pressure_in_the_line_lets_in_what_flows_out(k_s, k_t, k_b, p_s, p_t, p, delta):
    """V22: the root of an independent solver; compiled equal to Python."""
    found = line_pressure(k_s, k_t, k_b, p_s, p_t, p, delta)
    assert found == line_pressure.py_func(k_s, k_t, k_b, p_s, p_t, p, delta)

    def excess(at):
        return (k_s * signed_sqrt(p_s - at, delta) - k_t * signed_sqrt(at - p_t, delta)
                - k_b * signed_sqrt(at - p, delta))
    low, high = min(p, p_s, p_t), max(p, p_s, p_t)
    if k_s + k_t + k_b == 0.0:
        assert found == p
        return
    assert low - 1e-3 <= found <= high + 1e-3
    # 1e-12 of the largest flow: the last digits of its terms
    assert abs(excess(found)) <= 1e-12 * (k_s + k_t + k_b) * math.sqrt(high - low + delta)


@pytest.mark.parametrize('lift', [0.0, 1e-3, 0.1, 1.0])
def test_the_smoothing_of_a_line_is_that_of_poppet_and_lands_in_series(lift):
    """V18 with K_1 K_2 / sqrt(K_1^2 + K_2^2): a closed poppet lets the lands drain nothing."""
    block, k_s, k_t = block_record(SHEET), 2e-7, 1e-7
    k_b = poppet_conductance(lift, block)
    series = (k_s + k_t) * k_b / math.hypot(k_s + k_t, k_b)
    _, delta = blocked_line(k_s, k_t, lift, SUPPLY, BACK, 5e6, 3e13, 1e3, block)
    assert delta == pytest.approx(smoothing(series, 3e13, 1e3), rel=1e-12)
    assert delta <= smoothing(k_s + k_t, 3e13, 1e3)


@pytest.mark.parametrize('dp', [-8e6, -1e3, 0.0, 50.0, 2e7])
def test_the_slope_of_the_smoothed_root_is_its_derivative(dp):
    step = 1.0 + 1e-6 * abs(dp)
    rise = (signed_sqrt(dp + step, 1e4) - signed_sqrt(dp - step, 1e4)) / (2.0 * step)
    assert root_slope(dp, 1e4) == pytest.approx(rise, rel=1e-5, abs=0.0)


@pytest.mark.parametrize('lift', [0.0, 1e-4, 0.03, 1.0])
@pytest.mark.parametrize('x', [-1.7e-4, -2e-5, 0.0, 2e-5, 1.7e-4])
def test_both_chambers_get_what_two_orifices_in_series_pass(lift, x):
    """V22 in the plant: against a bracketing solver of the two flows of each line."""
    plant = blocked_plant(leakage_lpm=0.3)
    y, rates = (rows_of(1, PLANT_STATE)[0] for _ in 'yr')
    y.mechanics.position, y.spool.position, y.block.lift = 0.05, x, lift
    y.chambers.p_a, y.chambers.p_b = 14e6, 3e6
    plant.block.slew = -7.0
    _, q_p, q_t = plant_rates(
        y, 0.05, 0.0, 0.0, SUPPLY, BACK, plant, False, rates, False, no_powers())
    (pa, at, bt, pb), _ = conductances(x, plant.valve)
    k_b = poppet_conductance(lift, plant.block)
    stored = 0.0
    for name, k_s, k_t, p in (('p_a', pa, at, 14e6), ('p_b', pb, bt, 3e6)):
        volume = plant.chambers.dead_volume + 0.05 * (
            plant.chambers.area_a if name == 'p_a' else plant.chambers.area_b)
        _, delta = blocked_line(k_s, k_t, lift, SUPPLY, BACK, p, plant.chambers.beta / volume,
                                plant.valve.delta, plant.block)

        def excess(line):
            return (k_s * signed_sqrt(SUPPLY - line, delta) - k_t * signed_sqrt(line - BACK, delta)
                    - k_b * signed_sqrt(line - p, delta))
        line = brentq(excess, BACK, SUPPLY, xtol=1e-6, rtol=1e-14)
        leak = plant.chambers.c_li * (14e6 - 3e6) * (1.0 if name == 'p_a' else -1.0)
        flow = k_b * signed_sqrt(line - p, delta) - leak
        assert rates.chambers[name] == pytest.approx(
            plant.chambers.beta / volume * flow, rel=1e-6, abs=1e-3)
        stored += flow + leak
    assert q_p - q_t == pytest.approx(stored, rel=1e-6, abs=1e-16)
    assert rates.block.lift == -7.0


@given(x=st.floats(-1.7e-4, 1.7e-4), lift=st.floats(0.0, 1.0), p_a=PRESSURE, p_b=PRESSURE)
def test_what_the_lines_lose_is_throttled(x, lift, p_a, p_b):
    """E2: P_S Q_P - P_T Q_T is what the chambers take up, leaks, lands, poppets and relief."""
    plant = blocked_plant()
    y, rates = (rows_of(1, PLANT_STATE)[0] for _ in 'yr')
    y.mechanics.position, y.spool.position, y.block.lift = 0.05, x, lift
    y.chambers.p_a, y.chambers.p_b = p_a, p_b
    powers = no_powers()
    _, q_p, q_t = plant_rates(
        y, 0.05, 0.0, 0.0, SUPPLY, BACK, plant, False, rates, True, powers)
    assert powers.throttling >= -1e-9 and powers.leakage > 0.0
    assert SUPPLY * q_p - BACK * q_t == pytest.approx(
        powers.leakage + powers.throttling + powers.cross_port + powers.relief
        + powers.compression, rel=1e-9, abs=1e-6)


def test_closed_poppets_without_leakage_shut_the_chambers_whatever_the_spool_does():
    plant = blocked_plant(leakage_lpm=0.0)
    plant.chambers.c_li = 0.0
    y, rates = (rows_of(1, PLANT_STATE)[0] for _ in 'yr')
    y.mechanics.position, y.spool.position = 0.05, 1.7e-4
    y.chambers.p_a, y.chambers.p_b = 2e6, 15e6
    plant_rates(y, 0.05, 0.0, 0.0, SUPPLY, BACK, plant, False, rates, False, no_powers())
    # 1e-13 of the flow of the open lands, 4e-4 m3/s, times 3e13 Pa/m3
    assert abs(rates.chambers.p_a) < 1e3 and abs(rates.chambers.p_b) < 1e3
