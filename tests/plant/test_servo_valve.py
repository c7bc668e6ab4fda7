"""Servo valve: data-sheet points, conservation, symmetry, bandwidth, jit == Python."""

import math

from hypothesis import given, strategies as st
from isa_ros.plant import coil, servo_valve
from isa_ros.plant.units import LPM, MILLI
import numpy as np
import pytest
from scipy.optimize import brentq
from tests.sheets import plant_row

SUPPLY = 20.7e6   # Pa, paper Table 2
LAND_DROP = 3.5e6  # Pa over one land, errata 2
WIDE = 7.0e6      # supply that puts LAND_DROP over each of two lands at mid pressure

MANIFOLD = plant_row('smart_manifold').valve
ISA_V5 = plant_row('isa_v5').valve
VALVES = pytest.mark.parametrize('valve', [MANIFOLD, ISA_V5], ids=['manifold', 'v5'])

spools = st.floats(-178e-6, 178e-6)
pressures = st.floats(0.0, 22.5e6)


def net_flow(current_ma: float) -> float:
    """Return the net flow of land P-A (factor 1) at LAND_DROP in m3/s, series current."""
    spool = current_ma * MILLI * MANIFOLD.k_spool
    return servo_valve.port_flows(
        spool, WIDE - LAND_DROP, LAND_DROP, WIDE, 0.0, MANIFOLD)[0]


def null_leakage(valve: np.record) -> float:
    """Return the supply flow at null with both chambers closed, in m3/s."""
    def closed(chamber: int, other: float) -> float:
        def flow(p: float) -> float:
            p_a, p_b = (p, other) if chamber == 0 else (other, p)
            return servo_valve.port_flows(0.0, p_a, p_b, SUPPLY, 0.0, valve)[chamber]
        return brentq(flow, 0.0, SUPPLY)
    p_a, p_b = closed(0, 0.0), closed(1, 0.0)
    return servo_valve.port_flows(0.0, p_a, p_b, SUPPLY, 0.0, valve)[2]


@pytest.mark.parametrize(('current_ma', 'flow_lpm'), [
    (1.0, 0.400), (2.0, 2.48), (4.008, 7.5), (5.0, 9.98)])
def test_flow_gain_meets_figure_5(current_ma, flow_lpm):
    """V4/V7: the slopes of Fig 5 per series mA; 1 % is physics.md's acceptance."""
    assert net_flow(current_ma) == pytest.approx(flow_lpm * LPM, rel=0.01)
    assert net_flow(-current_ma) == pytest.approx(-flow_lpm * LPM, rel=0.01)


@VALVES
def test_flow_curve_has_no_jump_at_the_dual_gain_point(valve):
    """V4: across two neighbouring floats g changes by the slope only (errata 3)."""
    below, above = valve.x_dg, math.nextafter(valve.x_dg, 1.0)
    step = servo_valve.flow_curve(above, valve) - servo_valve.flow_curve(below, valve)
    # one rounding of g itself (1.1e-16 relative) comes on top of k_high times the gap
    allowed = valve.k_high * (above - below) + 2.3e-16 * servo_valve.flow_curve(below, valve)
    assert 0.0 <= step <= allowed


def test_flow_slopes_are_the_errata_reading():
    """Errata 1: 0.400 and 2.500 l/min per mA are 0.18727 and 1.17041 m3/s per m of spool."""
    assert MANIFOLD.k_low == pytest.approx(0.18727, abs=5e-6)
    assert MANIFOLD.k_high == pytest.approx(1.17041, abs=5e-6)


@VALVES
def test_leakage_at_null_is_figure_6(valve):
    """V6/V9: 0.17 l/min in total at null, tolerance of physics.md section 4."""
    assert null_leakage(valve) == pytest.approx(0.170 * LPM, abs=0.015 * LPM)


@VALVES
def test_leakage_peaks_at_null(valve):
    """Fig 6: the closed lands leak less as the spool leaves null."""
    leaks = [servo_valve.leakage(u, valve) for u in np.linspace(0.0, valve.x_max, 50)]
    assert all(a > b for a, b in zip(leaks, leaks[1:]))


@VALVES
def test_tare_leakage_is_figure_6(valve):
    """V9: 0.06 l/min of tare remain beyond 4 mA, where closed lands barely leak."""
    spool = 4.0e-3 * valve.k_spool
    q_a, _, q_p, _ = servo_valve.port_flows(spool, 10e6, 10e6, SUPPLY, 0.0, valve)
    leak = servo_valve.leakage(spool, valve) * valve.f_pb * math.sqrt(10.7e6 / LAND_DROP)
    back = servo_valve.leakage(spool, valve) * valve.f_at * math.sqrt(10e6 / LAND_DROP)
    tare = q_p - (q_a + back) - leak
    assert tare == pytest.approx(0.06 * LPM, abs=0.005 * LPM)


def test_tare_saving_is_the_errata_reading():
    """Errata 13: (0.28 - 0.06) l/min at 20.7 MPa is 75.9 W; ours is the 0.06 share of it."""
    tare_power = MANIFOLD.c_tare * servo_valve.signed_sqrt(SUPPLY, MANIFOLD.delta) * SUPPLY
    assert 0.28 * LPM * SUPPLY - tare_power == pytest.approx(75.9, abs=0.005 * LPM * SUPPLY)


def test_land_factors_give_equal_speed_both_ways():
    """V8, section 2.3: at zero load both directions of the ISA v5 run at the same speed."""
    chambers = plant_row('isa_v5').chambers
    spool = 150e-6

    def speed(x: float) -> float:
        """Return the steady speed: flows match A v and the pressures balance the areas."""
        def imbalance(p_a: float) -> float:
            p_b = p_a * chambers.area_a / chambers.area_b
            q_a, q_b, _, _ = servo_valve.port_flows(x, p_a, p_b, SUPPLY, 0.0, ISA_V5)
            return q_a / chambers.area_a + q_b / chambers.area_b
        highest = SUPPLY * chambers.area_b / chambers.area_a
        p_a = brentq(imbalance, 0.0, highest)
        p_b = p_a * chambers.area_a / chambers.area_b
        return servo_valve.port_flows(x, p_a, p_b, SUPPLY, 0.0, ISA_V5)[0] / chambers.area_a

    # the orifices' smoothing is 0.25 % at 1 MPa and less above; the leak is under 0.2 %
    assert speed(-spool) == pytest.approx(-speed(spool), rel=0.005)


@given(x=spools, p_a=pressures, p_b=pressures, p_s=pressures, p_t=st.floats(0.0, 1e6))
def test_flow_is_conserved(x, p_a, p_b, p_s, p_t):
    """V9: what leaves the supply enters a chamber or the return: q_p = q_a + q_b + q_t."""
    for valve in (MANIFOLD, ISA_V5):
        q_a, q_b, q_p, q_t = servo_valve.port_flows(x, p_a, p_b, p_s, p_t, valve)
        scale = abs(q_a) + abs(q_b) + abs(q_p) + abs(q_t)
        # six additions of at most ``scale``, each rounded once
        assert q_p == pytest.approx(q_a + q_b + q_t, abs=1e-15 * scale + 1e-300)


@given(x=spools, p_a=pressures, p_b=pressures)
def test_a_matched_valve_is_odd(x, p_a, p_b):
    """Swapping the spool's sign and the chambers swaps the flows (all land factors 1)."""
    q_a, q_b, q_p, q_t = servo_valve.port_flows(x, p_a, p_b, SUPPLY, 0.0, MANIFOLD)
    r_a, r_b, r_p, r_t = servo_valve.port_flows(-x, p_b, p_a, SUPPLY, 0.0, MANIFOLD)
    assert (q_a, q_b) == (r_b, r_a)
    scale = abs(q_p) + abs(q_t)
    assert (q_p, q_t) == pytest.approx((r_p, r_t), abs=1e-15 * scale)


@given(dp=st.floats(-25e6, 25e6))
def test_orifice_is_odd_and_below_the_root(dp):
    """V5: odd, monotone sign, never above sqrt(|dp|)."""
    root = servo_valve.signed_sqrt(dp, 1e5)
    assert root == -servo_valve.signed_sqrt(-dp, 1e5)
    assert root * dp >= 0.0
    assert abs(root) <= math.sqrt(abs(dp)) * (1.0 + 1e-15)


def test_orifice_smoothing_is_a_quarter_percent_at_ten_delta():
    """V5: (1 + 1/100)^(-1/4) = 0.99752 at dp = 10 delta."""
    assert servo_valve.signed_sqrt(1e6, 1e5) / 1e3 == pytest.approx(1.01 ** -0.25, rel=1e-12)


@given(x=spools, p_a=pressures, p_b=pressures)
def test_compiled_flows_equal_their_python_source(x, p_a, p_b):
    """Replay depends on this: the compiler must not reorder a single rounding."""
    args = (x, p_a, p_b, SUPPLY, 0.0, ISA_V5)
    assert servo_valve.port_flows(*args) == servo_valve.port_flows.py_func(*args)


def spool_system(with_current_pole: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return (A, b) of the linear spool model from reference to spool, from the kernels."""
    def rates(y: np.ndarray, u: float) -> np.ndarray:
        spool = np.zeros(1, servo_valve.VALVE_STATE).view(np.recarray)[0]
        spool.spool, spool.velocity, spool.acceleration = y[:3]
        reference = y[3] if with_current_pole else u
        jerk = servo_valve.spool_jerk(reference, spool, MANIFOLD)
        amplifier = coil.current_rate(y[3], u, WEAK_COIL)
        return np.array([y[1], y[2], jerk, amplifier])
    basis = np.eye(4)
    # small enough for the voltage limit, linear, so the difference is exact to rounding
    matrix = np.array([rates(1e-6 * e, 0.0) for e in basis]).T / 1e-6
    return matrix, rates(np.zeros(4), 1e-6) / 1e-6


WEAK_COIL = plant_row('smart_manifold').coil


def minus_3_db(with_current_pole: bool) -> float:
    matrix, column = spool_system(with_current_pole)
    size = 4 if with_current_pole else 3

    def gain(hz: float) -> float:
        response = np.linalg.solve(
            2j * math.pi * hz * np.eye(size) - matrix[:size, :size], column[:size])
        return abs(response[0]) - math.sqrt(0.5)
    return brentq(gain, 1.0, 2000.0)


def test_closed_spool_loop_bandwidth():
    """V3 (eq 8 alone): -3 dB at 114.1 Hz, physics.md section 4."""
    assert minus_3_db(with_current_pole=False) == pytest.approx(114.1, abs=1.0)


def test_spool_behind_the_current_loop_bandwidth():
    """V1 + V3: eq 8 after eq 10 reaches 100 to 120 Hz, errata 20."""
    assert 100.0 <= minus_3_db(with_current_pole=True) <= 120.0


def test_amplifier_voltage_limits_a_large_current_step():
    """V1: 24 V over 9.2 H is 2.6 A/s at zero current, and nothing is left at 10 mA."""
    assert coil.current_rate(0.0, 0.010, WEAK_COIL) == pytest.approx(24.0 / 9.2)
    assert coil.current_rate(0.010, 0.020, WEAK_COIL) == pytest.approx(0.0, abs=1e-9)
    assert coil.current_rate(0.0, 0.001, WEAK_COIL) == pytest.approx(2.0)
