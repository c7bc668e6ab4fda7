"""Hoses between valve block and cylinder: volume, wall, resistance, leak and burst."""

from dataclasses import replace
import math

from hypothesis import given, strategies as st
from isa_ros.core.timebase import FASTEST_RATE, PLANT_STEP
from isa_ros.errors import ParameterError
from isa_ros.plant import hose
from isa_ros.plant.cavitation import lack
from isa_ros.plant.hose import (
    hose_contents, hose_flow, hoses_record, outward, series_flow, series_slope, soft_volume)
from isa_ros.plant.hose_sheets import (
    EffectiveWall, ExpandingWall, LumpedHoses, NoneHoses, RigidWall, smooth_drop)
import numpy as np
import pytest
from scipy.optimize import brentq
from tests.sheets import actuator_sheet, plant_row

SHEET = LumpedHoses(
    inner_diameter_mm=10.0, length_m=2.0, wall=ExpandingWall(
        expansion_ml_per_m=1.5, pressure_mpa=20.0), viscosity_mm2_per_s=46.0, density=870.0,
    rated_lpm=0.0, rated_drop_mpa=0.0)
LPM = 1e-3 / 60.0


def oil():
    """Return the `CHAMBERS` record of the ISA v5."""
    return np.rec.array(plant_row('isa_v5')).chambers


def row(sheet=SHEET, **values):
    return hoses_record(replace(sheet, **values), oil())


def reynolds(flow, sheet=SHEET):
    d = sheet.inner_diameter_mm * 1e-3
    return 4.0 * flow / (math.pi * d * sheet.viscosity_mm2_per_s * 1e-6)


def test_a_laminar_flow_is_that_of_hagen_and_poiseuille():
    """DP = 128 rho nu l Q/(pi d^4) up to Re 2300."""
    for flow in (1e-7, 1e-5, 5e-4, 8e-4):
        assert reynolds(flow) < 2300.0
        drop = 128.0 * 870.0 * 46e-6 * 2.0 * flow / (math.pi * 0.01 ** 4)
        assert smooth_drop(SHEET, flow) == pytest.approx(drop, rel=1e-12, abs=0.0)
        assert series_flow(drop, 0.0, 0.0, row()) == pytest.approx(flow, rel=1e-12, abs=0.0)
        assert series_flow(-drop, 0.0, 0.0, row()) == pytest.approx(-flow, rel=1e-12, abs=0.0)


def test_a_turbulent_flow_is_that_of_blasius_within_6_percent():
    """The factor a/Re + b meets 0.3164 Re^-1/4 at 2700 and 14000; from 2300 to 20000."""
    for re in np.geomspace(2301.0, 20e3, 40):
        flow = re * math.pi * 0.01 * 46e-6 / 4.0
        speed = flow / (math.pi / 4.0 * 1e-4)
        blasius = 0.3164 / re ** 0.25 * 2.0 / 0.01 * 0.5 * 870.0 * speed * speed
        assert smooth_drop(SHEET, flow) == pytest.approx(blasius, rel=0.06, abs=0.0)
        assert series_flow(smooth_drop(SHEET, flow), 0.0, 0.0, row()) == pytest.approx(
            flow, rel=1e-9, abs=0.0)
    for re in (2700.0, 14000.0):
        flow = re * math.pi * 0.01 * 46e-6 / 4.0
        speed = flow / (math.pi / 4.0 * 1e-4)
        blasius = 0.3164 / re ** 0.25 * 2.0 / 0.01 * 0.5 * 870.0 * speed * speed
        assert smooth_drop(SHEET, flow) == pytest.approx(blasius, rel=1e-12, abs=0.0)


def test_a_stated_drop_is_met_at_its_flow_and_its_surplus_grows_with_the_square():
    stated = row(rated_lpm=40.0, rated_drop_mpa=1.2)
    assert series_flow(1.2e6, 0.0, 0.0, stated) == pytest.approx(40.0 * LPM, rel=1e-12, abs=0.0)
    surplus = 1.2e6 - smooth_drop(SHEET, 40.0 * LPM)
    drop = smooth_drop(SHEET, 20.0 * LPM) + 0.25 * surplus
    assert series_flow(drop, 0.0, 0.0, stated) == pytest.approx(20.0 * LPM, rel=1e-12, abs=0.0)


@given(flow=st.floats(1e-9, 1e-2), square=st.just(0.0) | st.floats(1e8, 1e24),
       lag=st.just(0.0) | st.floats(1e5, 1e12))
def test_hose_and_orifice_in_series_have_one_flow(flow, square, lag):
    """C41: the drops of hose, orifice and lag add up; against the sum itself."""
    own = row(rated_lpm=40.0, rated_drop_mpa=1.2)
    smooth = smooth_drop(SHEET, flow)
    drop = smooth + own.fittings * flow * flow + square * flow * flow + lag * flow
    found = series_flow(drop, square, lag, own)
    assert found == pytest.approx(flow, rel=1e-9, abs=0.0)
    assert found == series_flow.py_func(drop, square, lag, own)
    step = 1e-4 * drop
    slope = series_slope(drop, square, own)
    rise = (series_flow(drop + step, square, 0.0, own)
            - series_flow(drop - step, square, 0.0, own)) / (2.0 * step)
    if lag == 0.0 and abs(reynolds(found) - 2300.0) > 2.0:  # off the corner
        assert 1.0 / slope == pytest.approx(rise, rel=1e-5, abs=0.0)


def test_between_laminar_and_turbulent_the_flow_stays_at_reynolds_2300():
    own = row()
    low, high = smooth_drop(SHEET, own.critical), smooth_drop(SHEET, own.critical * (1 + 1e-12))
    assert high > 1.5 * low
    for drop in np.linspace(low, high, 7):
        assert series_flow(drop, 0.0, 0.0, own) == pytest.approx(
            own.critical, rel=1e-9, abs=0.0)
    assert series_slope(0.5 * (low + high), 0.0, own) == 0.0


@pytest.mark.parametrize('wall, softness', [
    (RigidWall(), lambda beta, v: v / beta),
    (ExpandingWall(expansion_ml_per_m=1.5, pressure_mpa=20.0),
     lambda beta, v: v / beta + 1.5e-6 * 2.0 / 20e6),
    (EffectiveWall(bulk_modulus=4e8), lambda beta, v: v / 4e8)])
def test_the_wall_adds_its_expansion_to_that_of_the_oil(wall, softness):
    """C40: dV/dP of a hose of 157 ml, at 15 MPa."""
    own, volume = row(wall=wall), math.pi / 4.0 * 1e-4 * 2.0
    p, elastance, _ = hose_contents(lack(15e6, 0.0, soft_volume(own), own), 0.0, own)
    assert p == pytest.approx(15e6, rel=1e-12, abs=0.0)
    assert 1.0 / elastance == pytest.approx(softness(own.beta, volume), rel=1e-12, abs=0.0)


def test_oil_in_a_hose_boils_and_its_cavity_is_what_it_lacks():
    own = row()
    assert hose_contents(2e-6, 0.0, own) == (own.p_vapour, 0.0, 0.0)
    p, elastance, more = hose_contents(-1e-12, 0.0, own)
    assert own.p_vapour < p < own.p_vapour + 100.0 and elastance > 0.0 and more > 0.0


def test_a_drop_that_a_step_cannot_follow_decays_at_half_the_fastest_rate():
    """C42: with elastance E and flow Q_0 at rest, d(dP)/dt = E (Q_0 - Q) = -r (dP - dP_0)."""
    own, elastance, even = row(), 1e15, 3e-4
    rest = smooth_drop(SHEET, even)
    assert hose_flow(rest, 0.0, even, elastance, own) == pytest.approx(
        even, rel=1e-12, abs=0.0)
    for away in (1e3, -2e4, 1e5):
        flow = hose_flow(rest + away, 0.0, even, elastance, own)
        assert elastance * (even - flow) == pytest.approx(
            -0.5 * FASTEST_RATE * away, rel=1e-9, abs=0.0)
    slow = 1e10     # with so little elastance it is C41 itself
    assert hose_flow(2e5, 0.0, even, slow, own) == series_flow(2e5, 0.0, 0.0, own)


@given(drop=st.floats(-3e7, 3e7), even=st.floats(-1e-2, 1e-2), square=st.floats(0.0, 1e26),
       elastance=st.floats(0.0, 1e17))
def test_the_flow_of_any_step_stays_between_what_the_drop_and_rest_ask_for(
        drop, even, square, elastance):
    """C42: never beyond both; compiled equal to Python."""
    own = row()
    flow = hose_flow(drop, square, even, elastance, own)
    plain = series_flow(drop, square, 0.0, own)
    assert flow == hose_flow.py_func(drop, square, even, elastance, own)
    assert min(plain, even) - 1e-12 <= flow <= max(plain, even) + 1e-12
    # explicit steps of the drop do not grow: it moves towards rest by less than 2 of its distance
    moved = PLANT_STEP * elastance * (even - flow)
    root = brentq(lambda at: series_flow(at, square, 0.0, own) - even, -1e32, 1e32, rtol=1e-14) \
        if abs(even) > 1e-9 and square < 1e20 else None
    if root is not None and elastance < 1e15:
        # 1e-6: of the drop on the flat between laminar and turbulent, where any is at rest
        assert abs(drop + moved - root) <= abs(drop - root) * (1 + 1e-6) + 1e6


def test_what_leaks_and_bursts_goes_outside_and_nothing_comes_in():
    """C43: laminar, and an opening as wide as the bore with 0.6 sqrt(2/rho)."""
    own = row(burst_a=1.0, leakage_b=3e-12)
    k = 0.6 * math.pi / 4.0 * 1e-4 * math.sqrt(2.0 / 870.0)
    assert own.k_burst_a == pytest.approx(k, rel=1e-12, abs=0.0) and own.k_burst_b == 0.0
    assert outward(16e6, 1e9, 0.0, own.k_burst_a) == pytest.approx(k * 4e3, rel=1e-9, abs=0.0)
    assert outward(16e6, 1e9, own.c_out_b, 0.0) == pytest.approx(48e-6, rel=1e-12, abs=0.0)
    assert outward(-9e4, 1e9, own.c_out_b, own.k_burst_a) == 0.0
    elastance = 1e14    # near no pressure it empties at a quarter of the fastest rate
    assert outward(1e-3, elastance, 0.0, k) * elastance / 1e-3 == pytest.approx(
        0.25 * FASTEST_RATE, rel=1e-6, abs=0.0)


def test_warm_oil_is_thinner_and_softer_in_the_hose_too():
    own = row()
    sheets = float(own.beta)
    hose.warm_hoses(0.25, 0.9 * sheets, own)
    assert series_flow(1e4, 0.0, 0.0, own) == pytest.approx(
        4.0 * series_flow(1e4, 0.0, 0.0, row()), rel=1e-12, abs=0.0)
    assert soft_volume(own) / own.beta == pytest.approx(
        math.pi / 4.0 * 1e-4 * 2.0 / (0.9 * sheets) + 1.5e-6 * 2.0 / 20e6, rel=1e-12, abs=0.0)


def test_thin_oil_is_turbulent_at_less_flow():
    """C41 with a quarter of the viscosity: at Re 5000 of it, which is 1250 of the sheet's oil."""
    own, thin = row(), replace(SHEET, viscosity_mm2_per_s=0.25 * 46.0)
    hose.warm_hoses(0.25, float(own.beta), own)
    flow = 1250.0 * math.pi * 0.01 * 46e-6 / 4.0
    drop = smooth_drop(thin, flow)
    assert drop > 1.5 * 0.25 * smooth_drop(SHEET, flow)
    assert series_flow(drop, 0.0, 0.0, own) == pytest.approx(flow, rel=1e-9, abs=0.0)
    rise = (series_flow(1.0001 * drop, 0.0, 0.0, own)
            - series_flow(0.9999 * drop, 0.0, 0.0, own)) / (2e-4 * drop)
    assert 1.0 / series_slope(drop, 0.0, own) == pytest.approx(rise, rel=1e-6, abs=0.0)


@pytest.mark.parametrize('values, message', [
    ({'rated_lpm': 40.0}, 'rated_lpm = 40 l/min and rated_drop_mpa = 0 MPa, must both be 0'),
    ({'rated_drop_mpa': 1.0}, 'rated_lpm = 0 l/min and rated_drop_mpa = 1 MPa'),
    ({'rated_lpm': 40.0, 'rated_drop_mpa': 0.1},
     'rated_drop_mpa = 0.1 MPa at rated_lpm = 40 l/min, must be >= 0.217 MPa, that of a smooth'),
    ({'inner_diameter_mm': 0.5}, 'inner_diameter_mm = 0.5 mm, must be >= 1 mm'),
    ({'length_m': 0.0}, 'length_m = 0 m, must be >= 0.05 m'),
    ({'wall': ExpandingWall(expansion_ml_per_m=79.0, pressure_mpa=20.0)},
     'wall.expansion_ml_per_m = 79 ml/m, must be < 78.54 ml/m, what inner_diameter_mm = 10 mm'),
    ({'burst_a': 0.5}, 'burst_a = 0.5, must be a whole number')])
def test_what_contradicts_itself_is_refused_with_both_numbers(values, message):
    with pytest.raises(ParameterError) as refused:
        replace(SHEET, **values)
    assert message in str(refused.value)


def test_a_drop_may_be_rounded_as_sheets_print_it_and_a_wall_grow_by_less_than_its_hose():
    """0.5 % below a smooth hose's is the rounding of three digits; all of a hose is refused."""
    smooth = smooth_drop(SHEET, 40.0 * LPM) / 1e6
    assert row(rated_lpm=40.0, rated_drop_mpa=0.996 * smooth).fittings == 0.0
    with pytest.raises(ParameterError, match='that of a smooth'):
        replace(SHEET, rated_lpm=40.0, rated_drop_mpa=0.994 * smooth)
    held = SHEET.bore / 1e-6
    replace(SHEET, wall=ExpandingWall(expansion_ml_per_m=0.9999 * held, pressure_mpa=20.0))
    with pytest.raises(ParameterError, match='wall.expansion_ml_per_m'):
        replace(SHEET, wall=ExpandingWall(expansion_ml_per_m=held, pressure_mpa=20.0))


def test_air_is_in_the_hose_and_not_in_what_stands_for_its_wall():
    """C5 and C12 of 157 ml: dV/dP grows by V P/(p_air beta) below the atmosphere; free air a V."""
    own, plain, volume = row(), oil(), math.pi / 4.0 * 1e-4 * 2.0
    p, elastance, _ = hose_contents(lack(-5e4, 0.0, soft_volume(own), own), 0.0, own)
    assert p == pytest.approx(-5e4, rel=1e-9, abs=0.0)
    assert 1.0 / elastance - soft_volume(own) / own.beta == pytest.approx(
        volume * 5e4 / (plain.p_air * plain.beta), rel=1e-9, abs=0.0)
    plain.air = 0.02
    with_air = hoses_record(SHEET, plain)
    assert with_air.air * soft_volume(with_air) == pytest.approx(
        0.02 * volume, rel=1e-12, abs=0.0)


def test_a_wall_that_makes_oil_stiffer_is_refused():
    plant = actuator_sheet('isa_v5').plant
    with pytest.raises(ParameterError, match=(
            r'hoses.wall.bulk_modulus = 1.9e\+09 Pa, must be <= 7e\+08 Pa, oil.effective')):
        replace(plant, hoses=replace(SHEET, wall=EffectiveWall(bulk_modulus=1.9e9)))


def test_without_hoses_the_record_is_off():
    assert hoses_record(NoneHoses(), oil()).is_on == 0.0
