"""Pilot-operated check valve and counterbalance valve: what opens them, and how far."""

from dataclasses import replace
import math

from isa_ros.core.record import row_record, rows_of
from isa_ros.errors import ParameterError
from isa_ros.plant.counterbalance import counterbalance_excess, counterbalance_record
from isa_ros.plant.linearised import LoadSide
from isa_ros.plant.load_holding import least_lag, lift_rate, poppet_square
from isa_ros.plant.pilot_check import pilot_check_excess, pilot_check_record
from isa_ros.plant.plant import plant_record, PLANT_STATE
from isa_ros.plant.rest_oil import null_pressures, rest_oil
from isa_ros.plant.service_lines import sensed_pressures
from isa_ros.plant.step_limits import refuse_too_fast
import numpy as np
import pytest
from tests.actuator.hosed_cylinder import CHECK, COUNTERBALANCE, HOSES
from tests.sheets import actuator_sheet


@pytest.mark.parametrize('load, line, pilot, opens', [
    (12.1e6, 0.0, 0.0, True), (11.9e6, 0.0, 0.0, False),     # relief at the setting
    (9.0e6, 0.0, 1.1e6, True), (9.0e6, 0.0, 0.9e6, False),   # 3 times the pilot helps
    (16.1e6, 1.0e6, 0.0, True), (15.9e6, 1.0e6, 0.0, False)])    # 4 times the line hinders
def test_a_counterbalance_valve_opens_at_setting_pilot_and_back_pressure(load, line, pilot, opens):
    """V43 with R = 3, 12 MPa; a vented spring chamber ignores the line."""
    own = counterbalance_record(COUNTERBALANCE)
    excess = counterbalance_excess(load, line, pilot, own)
    assert (excess > 0.0) is opens and abs(excess) == pytest.approx(
        0.3e6 if pilot else 0.1e6, rel=1e-9)
    assert excess == counterbalance_excess.py_func(load, line, pilot, own)
    vented = counterbalance_record(replace(COUNTERBALANCE, spring_chamber='vented'))
    assert counterbalance_excess(load, line, pilot, vented) == pytest.approx(
        excess + 4.0 * line, rel=1e-9)


@pytest.mark.parametrize('load, line, pilot, opens', [
    (8.0e6, 0.0, 2.1e6, True), (8.0e6, 0.0, 2.0e6, False),      # 4 pilots over load and spring
    (8.0e6, 2.0e6, 3.6e6, True), (8.0e6, 2.0e6, 3.5e6, False)])     # 3.575: the line hinders
def test_a_pilot_check_opens_when_pilot_over_line_beats_load_and_spring(load, line, pilot, opens):
    """V42 with R = 4, 0.3 MPa."""
    own = pilot_check_record(CHECK)
    excess = pilot_check_excess(load, line, pilot, own)
    assert (excess > 0.0) is opens and abs(excess) == pytest.approx(
        4.0 * (pilot - line) - (load - line) - 0.3e6, rel=1e-9) or not opens
    assert excess == pilot_check_excess.py_func(load, line, pilot, own)
    outside = pilot_check_record(replace(CHECK, drain='outside'))
    assert pilot_check_excess(load, line, pilot, outside) == pytest.approx(
        excess + 4.0 * line, rel=1e-9)


@pytest.mark.parametrize('record, excess, line, target', [
    (counterbalance_record(COUNTERBALANCE), 1.0e6, 0.0, 0.25),
    (counterbalance_record(COUNTERBALANCE), 5.0e6, 0.0, 1.0),
    (counterbalance_record(COUNTERBALANCE), -9e6, 5.3e6, 0.5),
    (pilot_check_record(CHECK), 0.1e6, 0.0, 0.25),
    (pilot_check_record(CHECK), -9e6, 5.5e6, 0.5),
    (pilot_check_record(CHECK), -9e6, 5.2e6, 0.0)])
def test_the_lift_follows_with_its_lag(record, excess, line, target):
    """V40: from a load of 5 MPa; the check valves open over 0.2 and 0.4 MPa."""
    for lift in (0.0, 0.4, 1.0):
        rate = lift_rate(lift, excess, 5e6, line, record)
        assert rate == pytest.approx((target - lift) / 5e-3, rel=1e-9, abs=1e-9)
        assert rate == lift_rate.py_func(lift, excess, 5e6, line, record)


@pytest.mark.parametrize('sheet', [CHECK, COUNTERBALANCE], ids=['check', 'counterbalance'])
def test_a_poppet_is_not_stuck_in_two_places(sheet):
    with pytest.raises(ParameterError, match='stuck_open = 1 and stuck_shut = 1, must not both'):
        replace(sheet, stuck_open=1.0, stuck_shut=1.0)


@pytest.mark.parametrize('force', [-15e3, 0.0, 5e3])
def test_a_hose_at_rest_is_no_higher_than_its_chamber_behind_the_valve(force):
    """A weight that pulls has A below half of the supply, one that pushes B: no oil enters."""
    sheet = actuator_sheet('cylinder').plant
    own = row_record(plant_record(replace(
        sheet, hoses=HOSES, holding_a=COUNTERBALANCE, holding_b=CHECK)))
    at = rows_of(1, PLANT_STATE)[0]
    at.mechanics.position = 0.1
    rest_oil(own, 16e6, 0.0, force, at)
    lowest = np.minimum((at.chambers.p_a, at.chambers.p_b), null_pressures(own, 16e6, 0.0))
    assert sensed_pressures(at, own) == pytest.approx(tuple(lowest), rel=0.0, abs=1.0)
    assert bool(lowest[0] < at.chambers.p_a) is (force > 0.0)
    assert bool(lowest[1] < at.chambers.p_b) is (force <= 0.0)


def test_an_open_valve_has_its_rated_flow_and_a_shut_one_its_leakage():
    """V41: 30 l/min at 3 MPa out, 60 l/min at 0.5 MPa in, 2.5e-4 l/min at 21 MPa."""
    own = counterbalance_record(COUNTERBALANCE)
    for drop, lift, flow in ((-3e6, 1.0, 30.0), (0.5e6, 1.0, 60.0), (-21e6, 0.0, 2.5e-4)):
        square = poppet_square(drop, lift, own)
        assert math.sqrt(abs(drop) / square) * 60e3 == pytest.approx(
            flow, rel=1e-9, abs=0.0)
        assert square == poppet_square.py_func(drop, lift, own)
    half = (30.0 / 60e3 / math.sqrt(3e6) + 2.5e-4 / 60e3 / math.sqrt(21e6)) / 2.0
    assert 1.0 / math.sqrt(poppet_square(-1e6, 0.5, own)) == pytest.approx(
        half, rel=1e-9, abs=0.0)
    tight = counterbalance_record(replace(COUNTERBALANCE, leakage_lpm=0.0))
    assert poppet_square(-1e6, 0.0, tight) == -1.0


@pytest.mark.parametrize('sheet, build', [
    (COUNTERBALANCE, counterbalance_record), (CHECK, pilot_check_record)])
def test_faults_change_what_they_name(sheet, build):
    sound = build(sheet)
    leaking = build(replace(sheet, leaking_lpm=2.0))
    assert leaking.k_shut == pytest.approx(
        sound.k_shut + 2.0 / 60e3 / math.sqrt(21e6), rel=1e-12, abs=0.0)
    assert build(replace(sheet, spring_broken=1.0)).setting == 0.0 < sound.setting
    assert lift_rate(0.2, -9e6, 5e6, 0.0, build(replace(sheet, stuck_open=1.0))) > 0.0
    shut = build(replace(sheet, stuck_shut=1.0))
    assert lift_rate(0.2, 9e6, 5e6, 0.0, shut) < 0.0


def test_a_stuck_pilot_check_has_no_check_valve_a_stuck_counterbalance_valve_has():
    for sheet, build, opens in ((CHECK, pilot_check_record, False),
                                (COUNTERBALANCE, counterbalance_record, True)):
        own = build(replace(sheet, stuck_shut=1.0))
        assert (lift_rate(0.0, 0.0, 5e6, 6e6, own) > 0.0) is opens


def with_lines(**parts):
    return replace(actuator_sheet('isa_v5').plant, **parts)


@pytest.mark.parametrize('parts, message', [
    ({'holding_b': CHECK}, 'holding_b: a load-holding valve compares the pressures of the lines'),
    ({'holding_a': COUNTERBALANCE}, 'set hoses.kind: lumped')])
def test_a_load_holding_valve_without_hoses_is_refused(parts, message):
    with pytest.raises(ParameterError, match=message):
        with_lines(**parts)


def test_a_poppet_that_swings_on_its_oil_within_a_step_is_refused_and_its_bound_is_accepted():
    """The least lag is half a radian a step at the relief pressure; its bound is its own."""
    quick = replace(CHECK, lag_ms=0.1, rated_lpm=200.0)
    plant = row_record(plant_record(with_lines(hoses=HOSES, holding_b=quick)))
    least = least_lag(plant.holding_b, plant.chambers.beta / plant.chambers.dead_volume,
                      plant.hoses.beta / (plant.hoses.volume * (
                          1.0 + plant.hoses.beta * plant.hoses.per_wall)), plant.relief.p_open)
    k = 200.0 / 60e3 / math.sqrt(0.5e6)
    oil, soft = plant.chambers, plant.hoses.volume * (
        1.0 / plant.hoses.beta + plant.hoses.per_wall)
    swing = k * math.sqrt(plant.relief.p_open) / 0.4e6 * (
        oil.beta / oil.dead_volume + 5.0 / soft)    # w^2 times the lag
    assert least == pytest.approx(swing * 40e-6 * 40e-6, rel=1e-9, abs=0.0)
    with pytest.raises(ParameterError, match=(
            r'plant.holding_b.lag_ms = 0.1 ms, must be >= [0-9.]+ ms with its flow, its opening')):
        refuse_too_fast(plant, with_lines(), LoadSide())
    plant.holding_b.lag = least
    refuse_too_fast(plant, with_lines(), LoadSide())


@pytest.mark.parametrize('sheet, key, value', [
    (CHECK, 'pilot_ratio', 0.0), (CHECK, 'lag_ms', 0.05), (CHECK, 'opening_mpa', 0.0),
    (COUNTERBALANCE, 'setting_mpa', 0.0), (COUNTERBALANCE, 'check_rated_drop_mpa', 30.0),
    (COUNTERBALANCE, 'stuck_open', 0.5)])
def test_values_out_of_range_are_refused_by_name(sheet, key, value):
    with pytest.raises(ParameterError, match=f'{key} = '):
        replace(sheet, **{key: value})
