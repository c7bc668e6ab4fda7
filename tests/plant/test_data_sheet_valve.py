"""A valve of a data sheet: its points of flow, leakage and frequency response come out again."""

from dataclasses import replace
import math

from hypothesis import given, strategies as st
from isa_ros.core.units import LPM, MILLI, MPA
from isa_ros.errors import ParameterError
from isa_ros.plant import servo_valve
from isa_ros.plant.spool import DataSheetSpool, NullBias
from isa_ros.plant.valve_record import valve_record
from isa_ros.plant.valve_sheets import DataSheetValve, Lap, PointsFlow, StatedLeakage, StraightFlow
import numpy as np
import pytest
from scipy.optimize import brentq

RATIO = 1.641  # A_A/A_B of 40/25 mm
DROP = 7.0 * MPA
FLOW = PointsFlow(current_ma=(0.0, 1.0, 4.0, 10.0), flow_lpm=(0.0, 1.0, 10.0, 19.0))
LEAKAGE = StatedLeakage(
    pressure_mpa=14.0, current_ma=(0.0, 0.3, 1.0, 10.0), total_lpm=(1.1, 0.8, 0.5, 0.4),
    tare_lpm=0.3)
NO_LAP = Lap(pa_um=0.0, at_um=0.0, bt_um=0.0, pb_um=0.0)
SHEET = DataSheetValve(
    rated_drop_mpa=7.0, spool_travel_mm=0.5, flow=FLOW, leakage=LEAKAGE,
    orifice_smoothing_kpa=1e-3, slots='equal', lap=NO_LAP, hysteresis_percent=0.0,
    threshold_percent=0.0, hysteresis_from_percent=20.0, dead_band_percent=0.0,
    compensated_drop_mpa=0.0)
STRAIGHT = replace(SHEET, flow=StraightFlow(rated_current_ma=40.0, rated_flow_lpm=19.0))
NO_BIAS = NullBias(
    current_ma=0.0, supply_ma_per_mpa=0.0, return_ma_per_mpa=0.0, temperature_ua_per_k=0.0,
    reference_supply_mpa=14.0, reference_celsius=40.0)

spools = st.floats(-0.5e-3, 0.5e-3)
pressures = st.floats(0.0, 16e6)


def valve(sheet: DataSheetValve = SHEET, ratio: float = RATIO) -> np.record:
    """Return the `VALVE` record of a sheet."""
    return valve_record(sheet, ratio)


def rated_flow(current_ma: float, record: np.record) -> float:
    """Return the flow from port A to port B without a load at the rated drop, l/min."""
    middle = 0.5 * DROP
    x = current_ma * MILLI * record.k_spool
    return servo_valve.port_flows(x, middle, middle, DROP, 0.0, record)[0] / LPM


def shut_leakage(current_ma: float, pressure: float, record: np.record) -> float:
    """Return the supply flow with both ports shut, l/min."""
    x = current_ma * MILLI * record.k_spool

    def shut(chamber: int) -> float:
        def flow(p: float) -> float:
            return servo_valve.port_flows(x, p, p, pressure, 0.0, record)[chamber]
        return brentq(flow, 0.0, pressure, xtol=1e-9)
    return servo_valve.port_flows(x, shut(0), shut(1), pressure, 0.0, record)[2] / LPM


@pytest.mark.parametrize(('current', 'flow'), list(zip(FLOW.current_ma, FLOW.flow_lpm)))
def test_the_stated_flows_come_out(current, flow):
    """V15: without a load half the drop is over each land; leakage crosses it both ways alike."""
    # the smoothing of 1 Pa is 1e-14 of 3.5 MPa; a dozen roundings
    assert rated_flow(current, valve()) == pytest.approx(flow, rel=1e-12, abs=1e-12)
    assert rated_flow(-current, valve()) == pytest.approx(-flow, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize('share', [0.1, 0.5, 1.0])
def test_a_rated_flow_alone_is_a_straight_curve(share):
    assert rated_flow(share * 40.0, valve(STRAIGHT)) == pytest.approx(19.0 * share, rel=1e-12)


@pytest.mark.parametrize('slots', ['equal', 'matched'])
@pytest.mark.parametrize(
    ('current', 'total'), list(zip(LEAKAGE.current_ma, LEAKAGE.total_lpm)))
def test_the_stated_leakages_come_out(current, total, slots):
    """V16: both ports shut, at the stated pressure, also with slots of unequal areas."""
    record = valve(replace(SHEET, slots=slots))
    # brentq leaves 1e-9 Pa of 14 MPa: far below the smoothing's 1 Pa on the least drop
    assert shut_leakage(current, 14.0 * MPA, record) == pytest.approx(total, rel=1e-6)


def test_leakage_grows_with_the_root_of_the_pressure():
    """V16, V9: pilot stage and lands are orifices."""
    record = valve()
    assert shut_leakage(0.0, 3.5 * MPA, record) == pytest.approx(0.5 * 1.1, rel=1e-6)


def test_all_leakage_may_be_the_pilot_stage_s():
    """V16: closed lands that do not leak."""
    record = valve(replace(SHEET, leakage=replace(LEAKAGE, total_lpm=(0.3,) * 4)))
    assert not record.leak.y[:4].any()
    assert record.c_tare * math.sqrt(14.0 * MPA) == pytest.approx(0.3 * LPM, rel=1e-12, abs=0.0)


@given(x=spools, p_a=pressures, p_b=pressures)
def test_flow_is_conserved(x, p_a, p_b):
    """V9: q_p = q_a + q_b + q_t."""
    q_a, q_b, q_p, q_t = servo_valve.port_flows(x, p_a, p_b, 14e6, 0.0, valve())
    scale = abs(q_a) + abs(q_b) + abs(q_p) + abs(q_t)
    assert q_p == pytest.approx(q_a + q_b + q_t, rel=0.0, abs=1e-15 * scale + 1e-300)


@given(x=spools, p_a=pressures, p_b=pressures)
def test_compiled_flows_equal_their_python_source(x, p_a, p_b):
    args = (x, p_a, p_b, 14e6, 0.0, valve())
    assert servo_valve.port_flows(*args) == servo_valve.port_flows.py_func(*args)


@pytest.mark.parametrize(('change', 'message'), [
    ({'current_ma': (0.0, 4.0, 1.0, 10.0)},
     r'current_ma\[2\] = 1 mA, must be > current_ma\[1\] = 4 mA'),
    ({'flow_lpm': (0.0, 2.0, 2.0, 19.0)},
     r'flow_lpm\[2\] = 2 l/min, must be > flow_lpm\[1\] = 2 l/min'),
    ({'current_ma': (1.0, 2.0, 4.0, 10.0)}, r'current_ma\[0\] = 1 mA, must be 0 mA'),
    ({'flow_lpm': (0.0, 19.0)}, 'flow_lpm has 2 points, must have 4 as current_ma'),
    ({'flow_lpm': (0.0, 1.0, math.nan, 19.0)}, r'flow_lpm\[2\] = nan l/min, must be finite'),
    ({'flow_lpm': (0.0, 1.0, '4', 19.0)}, r"flow_lpm\[2\] = '4', must be a number in l/min"),
    ({'flow_lpm': (0.0, 1.0, (2.0,), 19.0)}, r'flow_lpm\[2\] = \(2.0,\), must be one value'),
    ({'flow_lpm': (0.0,)}, 'must be a list of 2 to 16 numbers in l/min'),
    ({'flow_lpm': 19.0}, 'flow_lpm = 19.0, must be a list of 2 to 16 numbers in l/min'),
    ({'current_ma': tuple(map(float, range(17)))}, 'must be a list of 2 to 16 numbers in mA'),
])
def test_points_that_are_no_curve_are_refused(change, message):
    with pytest.raises(ParameterError, match=message):
        replace(FLOW, **change)


@pytest.mark.parametrize(('change', 'message'), [
    ({'tare_lpm': 0.45}, r'total_lpm\[3\] = 0.4 l/min, must be >= tare_lpm = 0.45 l/min'),
    ({'current_ma': (0.0, 0.3, 0.3, 10.0)}, r'current_ma\[2\] = 0.3 mA, must be > '),
    ({'total_lpm': (1.1, 0.8, 0.5, 0.6)}, r'total_lpm\[3\] = 0.6 l/min, must be <= total_lpm'
                                          r'\[2\] = 0.5 l/min'),
    ({'total_lpm': (1.1,)}, 'total_lpm has 1 points, must have 4'),
])
def test_points_that_are_no_leakage_are_refused(change, message):
    with pytest.raises(ParameterError, match=message):
        replace(LEAKAGE, **change)


def test_the_bend_is_that_of_two_lines_only():
    """R4 has one knee: 2 l/min/mA to 2 mA, then 0.5, four times as flat."""
    two = replace(SHEET, flow=PointsFlow(current_ma=(0.0, 2.0, 10.0), flow_lpm=(0.0, 4.0, 8.0)))
    assert two.bend == pytest.approx((2.0, 4.0), rel=1e-12)
    assert SHEET.bend is None and STRAIGHT.bend is None


@given(frequency=st.floats(1.0, 1e3), zeta=st.floats(0.05, 5.0))
def test_the_stated_point_is_on_the_response(frequency, zeta):
    """V17: H = w_n^2 / (w_n^2 - w^2 + 2 zeta w_n w j) has the phase or the amplitude stated."""
    w = 2.0 * math.pi * frequency
    for at, expected in (('minus_90_deg', 0.0), ('minus_3_db', math.sqrt(0.5))):
        w_n = DataSheetSpool(
            frequency_hz=frequency, at=at, damping_ratio=zeta,
            null_bias=NO_BIAS).natural_frequency_rad_per_s
        response = w_n * w_n / complex(w_n * w_n - w * w, 2.0 * zeta * w_n * w)
        measured = response.real if at == 'minus_90_deg' else abs(response)
        # 1 - 2 zeta^2 + sqrt(...) cancels to 1/(4 zeta^2): 1e-16 times 1e4 at zeta = 5
        assert measured == pytest.approx(expected, rel=1e-10, abs=1e-10)
