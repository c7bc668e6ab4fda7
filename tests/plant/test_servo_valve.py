"""Servo valve: data-sheet points, conservation, symmetry, bandwidth, jit == Python."""

import math

from hypothesis import given, strategies as st
from isa_ros.core.units import LPM, MILLI
from isa_ros.plant import servo_valve
from isa_ros.plant.plant import plant_record
import numpy as np
import pytest
from scipy.optimize import brentq
from tests.sheets import actuator_sheet, override, plant_row

SUPPLY = 20.7e6   # Pa, paper Table 2
LAND_DROP = 3.5e6  # Pa over one land, errata 2
WIDE = 7.0e6      # supply that puts LAND_DROP over each of two lands at mid pressure

MANIFOLD = plant_row('smart_manifold').valve
ISA_V5 = plant_row('isa_v5').valve
ISA_V2 = plant_row('isa_v2').valve
VALVES = pytest.mark.parametrize(
    'valve', [MANIFOLD, ISA_V5, ISA_V2], ids=['manifold', 'v5', 'v2'])
LEAKS = pytest.mark.parametrize(
    ('valve', 'at_null', 'tare'),
    [(MANIFOLD, 0.170, 0.06), (ISA_V5, 0.170, 0.06), (ISA_V2, 0.500, 0.28)],
    ids=['manifold', 'v5', 'v2'])

spools = st.floats(-178e-6, 178e-6)
pressures = st.floats(0.0, 22.5e6)


def net_flow(current_ma: float, valve: np.record = MANIFOLD) -> float:
    """Return the net flow of land P-A (factor 1) at LAND_DROP in m3/s, series current."""
    spool = current_ma * MILLI * valve.k_spool
    return servo_valve.port_flows(
        spool, WIDE - LAND_DROP, LAND_DROP, WIDE, 0.0, valve)[0]


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


@pytest.mark.parametrize('current_ma', [0.5, 1.0, 2.0])
def test_high_response_valve_gains_2_3_lpm_per_ma(current_ma):
    """V4, Fig 5: straight to 2 mA."""
    assert net_flow(current_ma, ISA_V2) == pytest.approx(2.3 * current_ma * LPM, rel=0.01)


def test_high_response_valve_falls_off_smoothly():
    """V4: 7.23 l/min at 5 mA (physics.md), never a growing slope, no kink at 2 mA."""
    assert net_flow(5.0, ISA_V2) == pytest.approx(7.23 * LPM, rel=0.01)
    openings = np.linspace(0.0, ISA_V2.x_max, 200)
    flows = np.array([servo_valve.flow_curve(u, ISA_V2) for u in openings])
    slopes = np.diff(flows) / np.diff(openings)
    # straight up to the knee: roundings of flows over one interval
    assert (np.diff(slopes) <= 1e-9 * slopes[0]).all()


@LEAKS
def test_leakage_at_null_is_figure_6(valve, at_null, tare):
    """V6/V9: total at null, tolerance of physics.md section 4."""
    assert null_leakage(valve) == pytest.approx(at_null * LPM, abs=0.015 * LPM)


@VALVES
def test_leakage_peaks_at_null(valve):
    """Fig 6: the closed lands leak less as the spool leaves null."""
    leaks = [servo_valve.leakage(u, valve) for u in np.linspace(0.0, valve.x_max, 50)]
    assert all(a > b for a, b in zip(leaks, leaks[1:]))


@LEAKS
def test_tare_leakage_is_figure_6(valve, at_null, tare):
    """V9: the tare remains beyond 4 mA, where closed lands barely leak."""
    spool = 4.0e-3 * valve.k_spool
    q_a, _, q_p, _ = servo_valve.port_flows(spool, 10e6, 10e6, SUPPLY, 0.0, valve)
    leak = servo_valve.leakage(spool, valve) * valve.f_pb * math.sqrt(10.7e6 / LAND_DROP)
    back = servo_valve.leakage(spool, valve) * valve.f_at * math.sqrt(10e6 / LAND_DROP)
    assert q_p - (q_a + back) - leak == pytest.approx(tare * LPM, abs=0.005 * LPM)


def test_tare_saving_is_the_errata_reading():
    """Errata 13: (0.28 - 0.06) l/min at 20.7 MPa is 75.9 W."""
    def tare_power(valve: np.record) -> float:
        return valve.c_tare * servo_valve.signed_sqrt(SUPPLY, valve.delta) * SUPPLY
    # the orifices' smoothing, delta 0.1 MPa at 20.7 MPa, is below 1e-5
    assert tare_power(ISA_V2) - tare_power(MANIFOLD) == pytest.approx(75.9, rel=1e-3)


def test_equal_slots_have_equal_factors():
    """V8: with equal slots all land factors are one."""
    assert (ISA_V2.f_pa, ISA_V2.f_at, ISA_V2.f_bt, ISA_V2.f_pb) == (1.0, 1.0, 1.0, 1.0)


def lapped(**laps: float) -> np.record:
    """Return the manifold's valve with overlaps in um."""
    sheet = actuator_sheet('smart_manifold')
    for land, lap in laps.items():
        sheet = override(sheet, f'plant.valve.lap.{land}_um', lap)
    return plant_record(sheet.plant)[0].valve


LAPPED = lapped(pa=5.0, at=-3.0, bt=8.0, pb=0.0)
UNLAPPED = lapped(pa=1.0)
UNLAPPED.lap_pa = 0.0


def test_overlap_shifts_the_flow_curve():
    """V14: a land with 10 um of overlap flows at x what one without does at x - 10 um."""
    valve = lapped(pa=10.0, at=10.0, bt=10.0, pb=10.0)
    for spool in (12e-6, 60e-6):
        assert servo_valve.land_flow(spool - valve.lap_pa, valve) == pytest.approx(
            servo_valve.land_flow(spool - 10e-6, MANIFOLD), rel=1e-12, abs=0.0)
    dead = servo_valve.port_flows(9e-6, WIDE - LAND_DROP, LAND_DROP, WIDE, 0.0, valve)[0]
    live = servo_valve.port_flows(9e-6, WIDE - LAND_DROP, LAND_DROP, WIDE, 0.0, MANIFOLD)[0]
    assert 0.0 < dead < 0.5 * live


@pytest.mark.parametrize(('land', 'spool', 'chamber', 'other'), [
    ('pa', 2e-5, 0, 1), ('at', -2e-5, 0, 1), ('bt', 2e-5, 1, 0), ('pb', -2e-5, 1, 0)])
def test_the_lap_of_a_land_takes_from_its_own_flow_only(land, spool, chamber, other):
    """V14: 10 um on one land at a time, the spool 20 um on the side that opens it."""
    own = servo_valve.port_flows(spool, 10e6, 10e6, SUPPLY, 0.0, lapped(**{land: 10.0}))
    plain = servo_valve.port_flows(spool, 10e6, 10e6, SUPPLY, 0.0, MANIFOLD)
    assert abs(own[chamber]) < 0.7 * abs(plain[chamber])
    assert own[other] == plain[other]


@given(x=spools, p_a=pressures, p_b=pressures)
def test_no_lap_is_the_plain_valve(x, p_a, p_b):
    """V14: the four lands one by one equal the shared evaluation, bit for bit."""
    plain = servo_valve.port_flows(x, p_a, p_b, SUPPLY, 0.0, MANIFOLD)
    assert servo_valve.port_flows(x, p_a, p_b, SUPPLY, 0.0, UNLAPPED) == plain


@given(x=spools, p_a=pressures, p_b=pressures)
def test_flow_is_conserved_with_lap(x, p_a, p_b):
    """V9 holds for any laps."""
    q_a, q_b, q_p, q_t = servo_valve.port_flows(x, p_a, p_b, SUPPLY, 0.0, LAPPED)
    scale = abs(q_a) + abs(q_b) + abs(q_p) + abs(q_t)
    assert q_p == pytest.approx(q_a + q_b + q_t, abs=1e-15 * scale)


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
    """V9: oil from the supply enters a chamber or the return: q_p = q_a + q_b + q_t."""
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
    assert servo_valve.signed_sqrt(1e6, 1e5) / 1e3 == pytest.approx(
        1.01 ** -0.25, rel=1e-12, abs=0.0)


@given(x=spools, p_a=pressures, p_b=pressures)
def test_compiled_flows_equal_their_python_source(x, p_a, p_b):
    """Replay depends on this: the compiler must not reorder a single rounding."""
    args = (x, p_a, p_b, SUPPLY, 0.0, ISA_V5)
    assert servo_valve.port_flows(*args) == servo_valve.port_flows.py_func(*args)


def test_a_supply_below_the_return_has_the_slope_of_the_way_back():
    """dQ/dP = Q/(2 dP) of both lands wide open: 0.7 MPa lets pass 5 times as much as 0.028."""
    valve = MANIFOLD
    found = [servo_valve.largest_flow_slope(valve, span) for span in (0.7e6, -0.7e6, -0.028e6)]
    flow = valve.per_root_drop * servo_valve.flow_curve(valve.x_max, valve) * 0.35e6 ** 0.5
    assert found[0] == found[1] == pytest.approx(0.5 * flow / 0.7e6, rel=1e-12, abs=0.0)
    assert found[2] == pytest.approx(5.0 * found[0], rel=1e-12, abs=0.0)
