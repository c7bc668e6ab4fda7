"""Faults of a supply: each against its own law."""

from dataclasses import replace

from isa_ros.config.runs.supplies import SupplyConfig
from isa_ros.core.constants import ATMOSPHERE
from isa_ros.errors import ConfigError
from isa_ros.surroundings import supply
import pytest
from tests.runs import ACCUMULATOR, CONSTANT, hip_and_knee
from tests.surroundings.made import surroundings_with

MS, DRAWN = 1_000_000, 5.0 / 6e4     # ns, m3/s
LPM_PER_MPA = 1.0 / 6e4 / 1e6


def supply_with(**changes: float) -> supply.Supply:
    """Return a supply at its set pressure, changed there."""
    made = supply.Supply(ACCUMULATOR, MS, 1e-12)
    made.change(replace(ACCUMULATOR, **changes))
    return made


def gas_and_line(pressure: float) -> float:
    """Return the oil that the accumulator and the line hold, up to a constant, m3."""
    own = ACCUMULATOR
    p_0 = own.precharge_mpa * 1e6 + ATMOSPHERE
    gas = own.gas_volume_l * 1e-3 * (p_0 / (pressure + ATMOSPHERE)) ** (
        1.0 / own.polytropic_exponent)
    return own.line_volume_l * 1e-3 / own.bulk_modulus * pressure - gas


def test_after_a_trip_of_the_pump_the_gas_gives_what_is_drawn():
    """C7 integrated: the oil of gas and line decreases by what was drawn."""
    tripped = supply_with(pump_flow_lpm=0.0)
    before = tripped.pressure
    for _ in range(100):
        tripped.advance(DRAWN * 1e-3)
    # RK4 of a smooth law in steps of 0.1 ms: rounding remains, of volumes of 3e-4 m3
    assert gas_and_line(before) - gas_and_line(tripped.pressure) == pytest.approx(
        100 * DRAWN * 1e-3, rel=1e-9, abs=0.0)
    assert tripped.state['pump_flow'][0] == 0.0


def test_without_gas_the_line_alone_gives_what_is_drawn():
    """C dP = -Q dt with C = V/beta of the line."""
    empty = supply_with(accumulator_lost=1.0, pump_flow_lpm=0.0)
    before = empty.pressure
    for _ in range(10):
        empty.advance(DRAWN * 1e-3)
    c = ACCUMULATOR.line_volume_l * 1e-3 / ACCUMULATOR.bulk_modulus
    assert before - empty.pressure == pytest.approx(10 * DRAWN * 1e-3 / c, rel=1e-12, abs=0.0)


def test_a_leaking_hose_takes_at_rest_what_the_pump_gives():
    """C8 at rest without a consumer: Q_pump = k P = Q_max (P_set - P)/band."""
    leaking = supply_with(line_leakage_lpm_per_mpa=0.3)
    for _ in range(3000):
        leaking.advance(0.0)
    k = 0.3 * LPM_PER_MPA
    slope = ACCUMULATOR.pump_flow_lpm / 6e4 / (ACCUMULATOR.pump_band_mpa * 1e6)
    expected = slope * ACCUMULATOR.pressure_mpa * 1e6 / (slope + k)
    assert leaking.pressure == pytest.approx(expected, rel=1e-9, abs=0.0)
    assert leaking.state['pump_flow'][0] == pytest.approx(k * expected, rel=1e-9, abs=0.0)
    before = float(leaking.state['relief_energy'][0])
    for _ in range(100):
        leaking.advance(0.0)
    assert leaking.state['relief_energy'][0] - before == pytest.approx(     # E7: P Q_leak
        k * expected * expected * 0.1, rel=1e-9, abs=0.0)


def test_an_open_relief_valve_takes_all_that_the_pump_gives():
    """At rest Q_max = k_relief (P - P_relief)."""
    opened = supply_with(relief_mpa=5.0)
    for _ in range(3000):
        opened.advance(0.0)
    above = ACCUMULATOR.pump_flow_lpm / ACCUMULATOR.relief_lpm_per_mpa
    assert opened.pressure == pytest.approx((5.0 + above) * 1e6, rel=1e-9, abs=0.0)


def test_an_ideal_supply_has_its_new_pressure_in_the_next_tick_and_the_old_one_after_it():
    surroundings = surroundings_with(hip_and_knee())
    pressures = []
    for values in ({'supply.pressure_mpa': 10.0}, {}, {'supply.pressure_mpa': 20.7}, {}):
        surroundings.tune(values)
        pressures.append(surroundings.tick())
    assert pressures == [10e6, 10e6, 20.7e6, 20.7e6]


def test_what_changed_is_told_once():
    surroundings = surroundings_with(hip_and_knee())
    surroundings.tune({'supply.pressure_mpa': 10.0})
    assert surroundings.tuned == {}
    surroundings.tick()
    assert surroundings.tuned == {'supply.pressure_mpa': 10.0}
    surroundings.tick()
    assert surroundings.tuned == {}
    assert surroundings.tuned_value('supply.pressure_mpa') == 10.0


def test_a_fault_of_a_supply_is_taken_off_without_a_value_of_its_own():
    """0 MPa are below the bound of the pressure; they are not its value then."""
    surroundings = surroundings_with(hip_and_knee())
    surroundings.tune({'+supply.pressure_mpa': 10.0})
    assert surroundings.tick() == 10e6
    surroundings.tune({'-supply.pressure_mpa': 0.0})
    assert surroundings.tick() == 20.7e6


@pytest.mark.parametrize('value', [True, 'high', None])
def test_a_value_of_a_supply_is_a_number(value):
    surroundings = surroundings_with(hip_and_knee())
    with pytest.raises(ConfigError, match=f'supply.pressure_mpa = {value!r}, must be a number'):
        surroundings.tune({'supply.pressure_mpa': value})
    assert surroundings.tuned_value('supply.pressure_mpa') == 20.7


@pytest.mark.parametrize(('values', 'message'), [
    ({'supply.presure_mpa': 1.0}, 'supply.presure_mpa is unknown; did you mean supply.pressure'),
    ({'supply.pressure_mpa': 0.0}, 'supply.pressure_mpa = 0 MPa, must be > 0 MPa'),
    ({'supply.return_pressure_mpa': 1.0, 'supply.pressure_mpa': 99.0}, 'must be <= 70 MPa')])
def test_of_values_of_which_one_is_refused_none_is_taken(values, message):
    surroundings = surroundings_with(hip_and_knee())
    with pytest.raises(ConfigError, match=message):
        surroundings.tune(values)
    assert surroundings.tick() == CONSTANT.pressure_mpa * 1e6
    assert surroundings.tuned == {}


def test_a_state_saved_in_a_fault_continues_in_it_and_a_restart_keeps_it():
    run = hip_and_knee()
    surroundings = surroundings_with(run)
    beginning = surroundings.snapshot()
    surroundings.tune({'supply.pressure_mpa': 10.0})
    surroundings.tick()
    twin = surroundings_with(run)
    twin.restore(surroundings.snapshot())
    assert twin.tuned == surroundings.tuned
    assert twin.tick() == surroundings.tick() == 10e6
    twin.restart(beginning)
    assert twin.supplies['pressure'][0] == 20.7e6
    assert twin.tick() == 10e6


def test_a_restored_accumulator_goes_on_with_its_changed_values():
    """Its pressure lags behind them, so that the state alone does not have them."""
    run = hip_and_knee([SupplyConfig('supply', ACCUMULATOR, ('hip', 'knee'))])
    surroundings, twin = surroundings_with(run), surroundings_with(run)
    surroundings.tune({'supply.pump_flow_lpm': 0.0, 'supply.line_leakage_lpm_per_mpa': 0.3})
    surroundings.tick()
    twin.restore(surroundings.snapshot())
    found = [(surroundings.tick(), twin.tick()) for _ in range(20)]
    assert all(own == other for own, other in found)
    assert found[-1][0] < found[0][0] - 1e3     # the leak is in force
