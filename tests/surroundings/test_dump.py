"""The dump of a supply: its time constant, its flow, its energy, and the way back."""

from dataclasses import replace
import math

from isa_ros.core.orifice import signed_sqrt
from isa_ros.core.parameter import defaults
from isa_ros.core.record import row_record
from isa_ros.surroundings import supply
from isa_ros.surroundings.accumulator import supply_rates
from isa_ros.surroundings.dump import dumped, LagDump, ValveDump
from isa_ros.surroundings.return_line import SUPPLY_STEP
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.surroundings.supplied import MS, SHEET, SLOPE

IDEAL = supply.ConstantSupply(pressure_mpa=20.7, return_pressure_mpa=0.5)
LAG = LagDump(time_constant_ms=40.0, opened=0.0)
VALVE = ValveDump(rated_lpm=20.0, rated_drop_mpa=0.7, time_constant_ms=30.0, opened=0.0)


def opened(sheet, value=1.0):
    """Return a sheet with the line of its dump open, or closed again."""
    return replace(sheet, dump=replace(sheet.dump, opened=value))


def test_an_ideal_supply_falls_to_its_return_and_rises_again_with_the_time_constant():
    """C14: exp(-t/T) of the way is left after each tick, whatever the tick."""
    for step in (MS, 4 * MS):
        sheet = replace(IDEAL, dump=LAG)
        plant = supply.Supply(sheet, step, SLOPE)
        plant.advance(0.0)
        assert plant.pressure == 20.7e6
        plant.change(opened(sheet))
        for k in range(1, 11):
            plant.advance(0.0)
            left = math.exp(-k * step * 1e-9 / 0.04)
            assert plant.pressure == pytest.approx(0.5e6 + 20.2e6 * left, rel=1e-12, abs=0.0)
        plant.change(sheet)
        before = plant.pressure
        plant.advance(0.0)
        assert 20.7e6 - plant.pressure == pytest.approx(
            (20.7e6 - before) * math.exp(-step * 1e-9 / 0.04), rel=1e-12, abs=0.0)


def test_a_sheet_with_an_open_line_begins_without_pressure():
    assert supply.Supply(opened(replace(IDEAL, dump=LAG)), MS, SLOPE).pressure == 0.5e6


def test_the_oil_of_an_accumulator_leaves_as_an_independent_integration_says():
    """C7, C8, C14: pressure and opening against DOP853, from 20 MPa down past the precharge."""
    sheet = replace(SHEET, dump=VALVE)
    plant, record = supply.Supply(sheet, MS, SLOPE), supply.supply_record(sheet)[0]
    plant.state['pump_flow'] = 1e-4
    plant.change(opened(sheet))
    k = 20e-3 / 60.0 / math.sqrt(0.7e6)

    def rates(t, y):
        z, p, pump = y
        c = supply.capacitance(p, record)
        return [(1.0 - z) / 0.03, (pump - z * k * signed_sqrt(p, 1e3)) / c, -pump / 0.03]
    exact = solve_ivp(rates, (0.0, 0.26), [0.0, 20.7e6, 1e-4], 'DOP853', rtol=1e-10, atol=1e-12,
                      dense_output=True)
    for tick in range(1, 251):
        plant.advance(0.0)
        z, p, _ = exact.sol(tick * 1e-3)
        assert plant.state['dump_opening'][0] == pytest.approx(z, rel=1e-7, abs=0.0)
        if p > 12.2e6:
            assert plant.pressure == pytest.approx(p, rel=1e-5, abs=0.0)
        else:   # the capacitance jumps within a step of 0.1 ms: at most two steps early or late
            assert exact.sol(tick * 1e-3 + 2e-4)[1] - 0.1e6 < plant.pressure
            assert plant.pressure < exact.sol(tick * 1e-3 - 2e-4)[1] + 0.1e6
    assert abs(plant.pressure) < 0.1e6 and plant.state['pump_flow'][0] < 1e-7


def test_the_pump_brings_the_pressure_back_once_the_line_is_closed():
    sheet = replace(SHEET, dump=VALVE)
    plant = supply.Supply(sheet, MS, SLOPE)
    plant.change(opened(sheet))
    for _ in range(400):
        plant.advance(0.0)
    assert plant.pressure < 0.1e6
    plant.change(sheet)
    for _ in range(3000):
        plant.advance(0.0)
    # nothing is drawn: what its pump brought too much stays
    assert 20.7e6 <= plant.pressure < 22.5e6
    assert plant.state['dump_opening'][0] < 1e-12


def test_the_account_closes_while_it_is_dumped_and_oil_is_drawn():
    """E9: pump and held are what is given, relieved and dumped, returned and stored."""
    sheet = opened(replace(SHEET, dump=VALVE))
    plant = supply.Supply(replace(SHEET, dump=VALVE), MS, SLOPE)
    plant.change(sheet)
    for k in range(200):
        plant.advance(1e-8 if k < 60 else 0.0, 1e-8 if k < 60 else 0.0)
    row = plant.state[0]
    used = [row[name] for name in (
        'energy', 'relief_energy', 'return_energy', 'stored_energy')]
    assert row['relief_energy'] > 1000.0
    # RK4 across the precharge, where the capacitance jumps by 40 times
    assert abs(row['pump_energy'] + row['held_energy'] - sum(used)) < 1e-3 * row['relief_energy']


def test_without_a_dump_valve_or_with_its_line_closed_nothing_changes():
    """The same bytes, in every tick."""
    plain, closed = (supply.Supply(own, MS, SLOPE) for own in (
        SHEET, replace(SHEET, dump=VALVE)))
    for _ in range(50):
        for plant in (plain, closed):
            plant.advance(2e-7)
    assert plain.state.tobytes() == closed.state.tobytes()


def test_rates_are_those_of_python():
    row = supply.supply_record(opened(replace(
        SHEET, dump=defaults(ValveDump)))).view(np.recarray)[0]
    for pressure in (0.0, 5e3, 5e6, 20e6):
        for opening in (0.0, 0.4, 1.0):
            arguments = (pressure, 1e-4, 5e-5, opening, row)
            assert supply_rates(*arguments) == supply_rates.py_func(*arguments)


def test_a_stiff_line_falls_no_faster_than_a_step_can_follow():
    """C14: the slope of the flow over the line's capacitance, 1.6 of a step; below it V5's own."""
    row = row_record(supply.supply_record(
        opened(replace(SHEET, dump=VALVE)))).dump_valve
    for elastance in (1e11, 1e13, 1e15):
        slope = (dumped(1.0, 1.0, elastance, row) - dumped(-1.0, 1.0, elastance, row)) / 2.0
        fastest = 1.6 / SUPPLY_STEP
        assert slope * elastance <= fastest * (1.0 + 1e-9)
    assert slope * elastance > 0.5 * fastest    # and not slower than it must be


def test_an_open_valve_has_its_rated_flow():
    """C14: 20 l/min at 0.7 MPa; of the line alone, V/beta."""
    sheet = opened(replace(SHEET, dump=VALVE))
    row = supply.supply_record(sheet)[0]
    fall = supply_rates(0.7e6, 0.0, 0.0, 1.0, row)[0]
    c = supply.capacitance(0.7e6, row)
    assert -fall * c == pytest.approx(20e-3 / 60.0, rel=1e-3, abs=0.0)
    assert np.isclose(supply_rates(0.7e6, 0.0, 0.0, 0.5, row)[0], 0.5 * fall, rtol=1e-3)
