"""A data sheet in full: two sides, pressure gain, drift of null, dead band, compensator."""

from dataclasses import replace

from isa_ros.actuator.sheet import refuse_wiring
from isa_ros.core.parameter import defaults
from isa_ros.core.units import LPM, MILLI, MPA
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.plant import servo_valve
from isa_ros.plant.block_valve import PoppetBlock
from isa_ros.plant.plant import plant_record
from isa_ros.plant.pressure_gain import land_leakage_at, PressureGain
from isa_ros.plant.stated_curves import NullShift, SidesFlow, StatedLeakage, StraightFlow
import numpy as np
import pytest
from tests.plant.test_data_sheet_valve import rated_flow, SHEET, shut_leakage, valve
from tests.sheets import actuator_sheet

SIDES = replace(SHEET, flow=SidesFlow(
    current_ma=(0.0, 4.0, 10.0), extending_lpm=(0.0, 10.0, 19.0), retracting_lpm=(0.0, 8.0, 17.0)))
NO_LEAK = StatedLeakage(pressure_mpa=14.0, current_ma=(0.0,), total_lpm=(0.4,), tare_lpm=0.3)
TIGHT = StatedLeakage(
    pressure_mpa=21.0, current_ma=(0.0, 10.0), total_lpm=(1.6, 0.5), tare_lpm=0.4)
STRAIGHT = replace(SHEET, leakage=TIGHT, flow=StraightFlow(
    rated_current_ma=40.0, rated_flow_lpm=20.0))
DEAD = replace(SHEET, leakage=NO_LEAK, dead_band_percent=9.0)
COMPENSATED = replace(
    SHEET, leakage=replace(NO_LEAK, total_lpm=(0.3,)), compensated_drop_mpa=0.8)


def load_pressure(current_ma: float, pressure: float, record: np.record) -> float:
    """Return p_A - p_B with both ports shut, as a share of the supply's; by bisection."""
    x, found = current_ma * MILLI * record.k_spool, []
    for chamber in (0, 1):
        low, high = 0.0, pressure
        for _ in range(60):
            p = 0.5 * (low + high)
            if servo_valve.port_flows(x, p, p, pressure, 0.0, record)[chamber] > 0.0:
                low = p
            else:
                high = p
        found.append(low)
    return (found[0] - found[1]) / pressure


@pytest.mark.parametrize(('current', 'flow'), [
    (4.0, 10.0), (10.0, 19.0), (7.0, 14.5), (-4.0, -8.0), (-10.0, -17.0), (-7.0, -12.5)])
@pytest.mark.parametrize('lap_um', [0.0, 1e-6])
def test_each_side_has_its_flow(current, flow, lap_um):
    """V15; also in the lands' own code of a lap, here of 1e-12 m."""
    sheet = replace(SIDES, lap=replace(SIDES.lap, at_um=lap_um, pb_um=lap_um))
    # a lap of 1e-12 m of 5e-4 m of travel
    assert rated_flow(current, valve(sheet)) == pytest.approx(flow, rel=1e-8)


@pytest.mark.parametrize('x', [-5e-4, -1e-4, 0.0, 2e-4])
@pytest.mark.parametrize('sheet', [SIDES, DEAD, COMPENSATED], ids=['sides', 'dead', 'compensated'])
def test_compiled_flows_equal_their_python_source(x, sheet):
    args = (x, 3e6, 9e6, 14e6, 0.0, valve(sheet))
    assert servo_valve.port_flows(*args) == servo_valve.port_flows.py_func(*args)


@pytest.mark.parametrize(('change', 'message'), [
    ({'retracting_lpm': (0.0, 8.0)}, 'retracting_lpm has 2 points, must have 3 as current_ma'),
    ({'retracting_lpm': (0.0, 8.0, 7.0)},
     r'retracting_lpm\[2\] = 7 l/min, must be > retracting_lpm\[1\] = 8 l/min'),
    ({'extending_lpm': (1.0, 8.0, 9.0)}, r'extending_lpm\[0\] = 1 l/min, must be 0 l/min')])
def test_sides_that_are_no_curve_are_refused(change, message):
    with pytest.raises(ParameterError, match=message):
        replace(SIDES.flow, **change)


@pytest.mark.parametrize('percent', [50.0, 60.0, 80.0, 90.0])
@pytest.mark.parametrize('at', [0.5, 1.0, 3.0])
def test_the_stated_pressure_gain_is_the_blocked_pressure(percent, at):
    """V27; at null and at the last point the leakage is still the stated one."""
    sheet = replace(STRAIGHT, leakage=replace(TIGHT, total_lpm=(9.0, 0.5)),
                    pressure_gain=PressureGain(current_percent=at, percent=percent))
    record = valve(sheet)
    # the smoothing of 1 Pa is 1e-7 of the drops
    assert load_pressure(0.4 * at, 21e6, record) == pytest.approx(0.01 * percent, rel=1e-6)
    assert load_pressure(-0.4 * at, 7e6, record) == pytest.approx(-0.01 * percent, rel=1e-6)
    assert shut_leakage(0.0, 21e6, record) == pytest.approx(9.0, rel=1e-6)
    assert shut_leakage(10.0, 21e6, record) == pytest.approx(0.5, rel=1e-6)


@pytest.mark.parametrize('asked', [30.0, 98.5])
def test_the_gain_that_a_stated_leakage_allows_is_said_and_accepted(asked):
    """The bound of the refusal, to its three digits: half of the last one beside it."""
    with pytest.raises(ParameterError) as refused:
        replace(STRAIGHT, pressure_gain=PressureGain(current_percent=1.0, percent=asked))
    _, bound, number, _ = str(refused.value).rsplit(' ', 3)
    inside = {'>=': 1.002, '<=': 0.999}[bound]
    replace(STRAIGHT, pressure_gain=PressureGain(
        current_percent=1.0, percent=float(number) * inside))
    with pytest.raises(ParameterError):
        replace(STRAIGHT, pressure_gain=PressureGain(
            current_percent=1.0, percent=float(number) / inside))


@pytest.mark.parametrize('least', [1e-60, 9.9e-4])
def test_a_pressure_gain_of_nothing_is_refused(least):
    """1e-3 % is one: the land leaks 1e5 times what it opens."""
    with pytest.raises(ParameterError, match=f'percent = {least:g} %, must be 0 % or >= 0.001 %'):
        PressureGain(current_percent=1.0, percent=least)
    own = PressureGain(current_percent=1.0, percent=1e-3)
    assert land_leakage_at(own, 2.0) == pytest.approx(2.0 / 1e-5, rel=1e-4)
    assert PressureGain(current_percent=1.0, percent=0.0).percent == 0.0


@pytest.mark.parametrize(('gain', 'message'), [
    ({'percent': 30.0}, r'pressure_gain.percent = 30 % at 0.4 mA needs a leakage of at least '
                        r'2.31 l/min at null, and leakage.total_lpm\[0\] = 1.6 l/min'),
    ({'percent': 98.5}, r'pressure_gain.percent = 98.5 % at 0.4 mA leaves at most 0.4\d* l/min to '
                        r'the next point, where leakage.total_lpm\[1\] = 0.5 l/min'),
    ({'current_percent': 30.0}, r'leakage.current_ma\[1\] = 10 mA, must be > 12 mA')])
def test_a_pressure_gain_that_contradicts_the_leakage_is_refused_with_both_numbers(gain, message):
    """20 l/min, 0.4 of the pilot stage, 21 MPa: 30 % at 1 % is 2.31 l/min at null."""
    with pytest.raises(ParameterError, match=message):
        replace(STRAIGHT, pressure_gain=PressureGain(
            **{'current_percent': 1.0, 'percent': 60.0} | gain))


@pytest.mark.parametrize(('change', 'message'), [
    ({'slots': 'matched'}, 'and slots = matched, must be equal'),
    ({'compensated_drop_mpa': 1.0}, 'and compensated_drop_mpa = 1.0, must be 0')])
def test_a_pressure_gain_is_that_of_four_equal_lands(change, message):
    with pytest.raises(ParameterError, match=message):
        replace(STRAIGHT, pressure_gain=PressureGain(current_percent=1.0, percent=60.0), **change)


def test_a_dead_band_has_no_flow_and_then_the_stated_one():
    """V26: 9 % of 10 mA; the points of the flow are at their currents, from the band's end on."""
    record = valve(DEAD)    # the closed lands leak less than 0.1 l/min
    for current in (-0.89, -0.3, 0.0, 0.5):
        assert abs(rated_flow(current, record)) < 0.1
    for current, flow in ((1.0, 1.0), (2.5, 5.5), (4.0, 10.0), (-10.0, -19.0)):
        assert rated_flow(current, record) == pytest.approx(flow, abs=0.1)


@pytest.mark.parametrize('current', [-0.89, 0.0, 0.5])
def test_in_the_dead_band_the_leakage_is_that_at_null(current):
    assert shut_leakage(current, 14e6, valve(DEAD)) == pytest.approx(0.4, rel=1e-6)


@pytest.mark.parametrize(('change', 'message'), [
    ({'leakage': TIGHT}, 'leakage.current_ma has 2 points, must have 1 with dead_band_percent'),
    ({'dead_band_percent': 10.0}, r'flow.current_ma\[1\] = 1 mA, must be > 1 mA, the dead'),
    ({'dead_band_percent': 51.0}, 'dead_band_percent = 51 %, must be <= 50 %')])
def test_a_dead_band_that_contradicts_the_sheet_is_refused(change, message):
    with pytest.raises(ParameterError, match=message):
        replace(DEAD, **{'dead_band_percent': 9.0} | change)


@pytest.mark.parametrize('load', [0.0, 3e6, 9e6, 13.1e6])
def test_a_compensated_valve_has_one_flow_whatever_the_load(load):
    """V30: 19 l/min at 3.5 MPa a land is 9.084 at 0.8 MPa, as long as the supply has that more."""
    record = valve(COMPENSATED)
    expected = 19.0 * np.sqrt(0.8 / 3.5)
    q_a = servo_valve.port_flows(0.5e-3, load, 0.0, 14e6, 0.0, record)[0] / LPM
    q_b = servo_valve.port_flows(-0.5e-3, 0.0, load, 14e6, 0.0, record)[1] / LPM
    assert q_a == pytest.approx(expected, rel=1e-9) and q_b == pytest.approx(expected, rel=1e-9)


def test_beyond_its_band_a_compensator_is_open():
    q_a = servo_valve.port_flows(0.5e-3, 13.8e6, 0.0, 14e6, 0.0, valve(COMPENSATED))[0] / LPM
    assert q_a == pytest.approx(19.0 * np.sqrt(0.2 / 3.5), rel=1e-9)


def test_its_leakage_is_the_stated_one():
    """V16 with the compensator's drop over the lands from the supply."""
    sheet = replace(COMPENSATED, leakage=replace(
        NO_LEAK, current_ma=(0.0, 10.0), total_lpm=(0.9, 0.5)))
    for current, total in ((0.0, 0.9), (10.0, 0.5)):
        assert shut_leakage(current, 14e6, valve(sheet)) == pytest.approx(total, rel=1e-6)


def test_null_shifts_as_stated():
    """2 % a 7 MPa and 2 % a 38 K of 10 mA, V12."""
    plant = actuator_sheet('cylinder').plant
    own = replace(plant.valve, null_shift=NullShift(
        supply_percent_per_mpa=2.0 / 7.0, temperature_percent_per_k=2.0 / 38.0))
    base = plant_record(plant)[0].spool
    warm = replace(plant, valve=own, oil=replace(plant.oil, temperature_celsius=78.0))
    found = plant_record(warm)[0]
    assert (found.spool.bias_s - base.bias_s) * 7.0 * MPA == pytest.approx(2e-4, rel=1e-9, abs=0.0)
    assert found.spool.bias - base.bias == pytest.approx(2e-4, rel=1e-9, abs=0.0)
    assert found.thermal.bias_per_k * 38.0 == pytest.approx(2e-4, rel=1e-9, abs=0.0)


@pytest.mark.parametrize(('change', 'variants', 'message'), [
    ({'compensated_drop_mpa': 1.0}, ['feedback_linearisation'], 'valve.compensated_drop_mpa'),
    ({'dead_band_percent': 5.0, 'leakage': NO_LEAK}, ['feedback_linearisation'], 'dead_band_perc'),
    ({'flow': SIDES.flow}, ['feedback_linearisation'], 'plant.valve.flow.kind = sides'),
    ({'compensated_drop_mpa': 1.0}, [], 'block_valve.kind = poppet, must be none')])
def test_what_does_not_go_with_the_valve_is_refused(change, variants, message):
    sheet = actuator_sheet('cylinder', 'default', *variants)
    plant = replace(sheet.plant, valve=replace(sheet.plant.valve, **change))
    if not variants:
        plant = replace(plant, block_valve=defaults(PoppetBlock))
    with pytest.raises(ConfigError, match=message):
        refuse_wiring(replace(sheet, plant=plant))
