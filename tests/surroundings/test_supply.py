"""Supply: capacitance, steady state, closure of both oil balances, what is refused."""

from dataclasses import replace
import math

from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.record import row_record
from isa_ros.core.units import LPM
from isa_ros.errors import ParameterError
from isa_ros.surroundings import return_line, supply
from isa_ros.surroundings.accumulator import stored_energy, SUPPLY, supply_rates
import numpy as np
import pytest
from scipy.integrate import quad
from tests.surroundings.supplied import MS, SHEET, SLOPE

LINE = return_line.VolumeReturn(oil_volume_l=10.0, bulk_modulus=1e9, tank_lpm_per_mpa=12.0)
C_LINE, G_TANK = 10e-3 / 1e9, 12.0 * LPM / 1e6  # a time constant of 50 ms


def test_capacitance_is_the_slope_of_the_gas_volume():
    """C7: dV/dP of V_0 (p_0/P)^(1/n), by central difference, plus the line."""
    record = supply.supply_record(SHEET)[0]
    p_0, pressure, dp = 12.0e6 + ATMOSPHERE, 20.0e6, 1e3

    def gas(p: float) -> float:
        return 0.32e-3 * (p_0 / (p + ATMOSPHERE)) ** (1.0 / 1.4)
    slope = (gas(pressure - dp) - gas(pressure + dp)) / (2.0 * dp)
    line = 0.2e-3 / 7e8
    # the central difference itself errs by (dp/P)^2, far below 1e-6
    assert supply.capacitance(pressure, record) == pytest.approx(slope + line, rel=1e-6, abs=0.0)


def test_an_empty_accumulator_leaves_the_line():
    """C7 below precharge."""
    record = supply.supply_record(SHEET)[0]
    assert supply.capacitance(5e6, record) == pytest.approx(0.2e-3 / 7e8, rel=1e-12, abs=0.0)


def test_pump_settles_where_it_delivers_what_is_drawn():
    """C8: at 6 of 12 l/min the pressure is half the compensator's band below the set point."""
    plant = supply.Supply(SHEET, MS, SLOPE)
    for _ in range(20_000):
        plant.advance(6.0 * LPM * 1e-3)
    assert plant.pressure == pytest.approx(20.7e6 - 0.25e6, abs=1.0)


def test_relief_valve_takes_what_is_pushed_back():
    """C8: 6 l/min pushed into the supply raise it 0.25 MPa above the relief pressure."""
    plant = supply.Supply(SHEET, MS, SLOPE)
    for _ in range(20_000):
        plant.advance(-6.0 * LPM * 1e-3)
    assert plant.pressure == pytest.approx(22.5e6 + 0.25e6, abs=1.0)


def gas_volume(pressure: float) -> float:
    """Return the gas of the accumulator by its gas law, m3."""
    return 0.32e-3 * (12.1013250e6 / (pressure + ATMOSPHERE)) ** (1.0 / 1.4)


def test_what_the_pump_gives_is_drawn_or_stored():
    """C8: pumped - drawn = gas displaced + oil compressed, over half a second of changing flow."""
    plant = supply.Supply(SHEET, MS, SLOPE)
    first, pumped, before = plant.pressure, 0.0, 0.0
    pressures = []
    for tick in range(500):
        plant.advance((3.0 + 3.0 * math.sin(0.05 * tick)) * LPM * 1e-3)
        pumped += 0.5e-3 * (before + float(plant.state['pump_flow'][0]))
        before = float(plant.state['pump_flow'][0])
        pressures.append(plant.pressure)
    assert 12e6 < min(pressures) < max(pressures) < 22.5e6  # not empty, relief valve closed
    stored = gas_volume(first) - gas_volume(plant.pressure) + (
        0.2e-3 / 7e8) * (plant.pressure - first)
    # The trapezoids of the pump's flow err by T h^2/12 max|Q''|. With dQ/dt <= q_max/lag = 7e-3
    # and a demand that changes by at most q_max/band q_max/C = 1e-2 m3/s2, Q'' <= 0.6 m3/s3.
    assert pumped - float(plant.state['drawn'][0]) == pytest.approx(stored, rel=0.0, abs=2.5e-8)
    assert float(plant.state['drawn'][0]) > 2e-5


def test_a_constant_supply_stays():
    """The ideal supply; it counts the oil nevertheless."""
    plant = supply.Supply(
        supply.ConstantSupply(pressure_mpa=20.7, return_pressure_mpa=0.5), MS, SLOPE)
    for drawn, returned in ((1.0, 0.25), (0.5, 0.125)):
        plant.advance(drawn, returned)
    assert (plant.pressure, plant.return_pressure) == (20.7e6, 0.5e6)
    assert (plant.state['drawn'][0], plant.state['returned'][0]) == (1.5, 0.375)


@pytest.mark.parametrize('sheet', [
    supply.ConstantSupply(pressure_mpa=20.7, return_pressure_mpa=0.5, return_line=LINE),
    replace(SHEET, return_pressure_mpa=0.5, return_line=LINE)], ids=['constant', 'accumulator'])
def test_a_return_line_settles_where_the_tank_takes_what_comes(sheet):
    """C9: P_tank + Q/G, 0.5 MPa above the tank at 6 l/min; what is drawn does not matter."""
    plant = supply.Supply(sheet, MS, SLOPE)
    for _ in range(2000):  # 40 time constants: 4e-18 of the step is left
        plant.advance(5.0 * LPM * 1e-3, 6.0 * LPM * 1e-3)
    assert plant.return_pressure == pytest.approx(0.5e6 + 6.0 * LPM / G_TANK, rel=1e-9)
    for _ in range(2000):
        plant.advance(5.0 * LPM * 1e-3, 0.0)
    assert plant.return_pressure == pytest.approx(0.5e6, rel=1e-9)


def test_a_return_line_rises_with_its_time_constant():
    """C9: P_tank + Q/G (1 - exp(-G t/C)); RK4 errs by (h G/C)^4/120 = 1e-13 of it."""
    plant = supply.Supply(
        supply.ConstantSupply(pressure_mpa=20.7, return_pressure_mpa=0.5, return_line=LINE),
        MS, SLOPE)
    for tick in range(1, 101):
        plant.advance(0.0, 6.0 * LPM * 1e-3)
        rise = 6.0 * LPM / G_TANK * (1.0 - math.exp(-G_TANK * tick * 1e-3 / C_LINE))
        assert plant.return_pressure == pytest.approx(0.5e6 + rise, rel=1e-9)


@pytest.mark.parametrize(('line', 'message'), [
    # C/slope: 1e-15 m3/Pa over 2e-12 m3/s/Pa
    (replace(LINE, oil_volume_l=1e-3), 'capacitance of the return line over flow slope = 0.5 ms, '
     'must be >= 10 ms (ten ticks); enlarge return_line.oil_volume_l'),
    # C/G: 1e-11 m3/Pa over 1.7e-7 m3/s/Pa
    (replace(LINE, tank_lpm_per_mpa=1e4), 'time constant of the return line = 0.06 ms, must be '
     '>= 0.1 ms; reduce return_line.tank_lpm_per_mpa')])
def test_a_return_line_that_cannot_be_integrated_is_refused(line, message):
    """By the name of its supply, with both numbers and the key."""
    sheet = supply.ConstantSupply(pressure_mpa=20.7, return_pressure_mpa=0.5, return_line=line)
    with pytest.raises(ParameterError) as refused:
        supply.Supply(sheet, MS, SLOPE, name='main')
    assert str(refused.value) == f'main: {message}'


def test_a_supply_too_small_for_the_tick_is_refused_with_both_numbers():
    """coupling.md: C over the valves' slope must last ten ticks."""
    with pytest.raises(ParameterError, match=r'must be >= 10 ms .*; enlarge gas_volume_l'):
        supply.Supply(SHEET, MS, flow_slope=1e-8)


def test_without_its_gas_only_the_line_can_be_enlarged():
    lost = replace(SHEET, accumulator_lost=1.0)
    with pytest.raises(ParameterError, match='; enlarge line_volume_l, or let the pressure move'):
        supply.Supply(lost, MS, flow_slope=1e-8)


def test_compiled_rates_equal_their_python_source():
    """The logarithm and exponential included."""
    record = supply.supply_record(SHEET)[0].tolist()
    row = row_record(np.array([record], SUPPLY))
    for pressure in np.linspace(1e6, 23e6, 200):
        assert supply_rates(pressure, 1e-4, 5e-5, 0.0, row) == \
            supply_rates.py_func(pressure, 1e-4, 5e-5, 0.0, row)


def test_a_compiled_return_line_equals_its_python_source():
    line = return_line.return_record(LINE, 0.5e6).view(np.recarray)
    ends = []
    for advance in (return_line.return_advance, return_line.return_advance.py_func):
        state = np.zeros(1, supply.SUPPLY_SAMPLE).view(np.recarray)
        for tick in range(50):
            advance(10, 1e-5 * tick, line, state)
        ends.append(state.tobytes())
    assert ends[0] == ends[1]


def test_the_energy_of_the_pump_is_used_or_stored():
    """E7: pump less relief valve less what was drawn is the work on the gas and on the line."""
    record = supply.supply_record(SHEET)[0]
    plant = supply.Supply(SHEET, MS, SLOPE)
    given = 0.0
    for k in range(4000):
        flow = (8.0 if k % 1000 < 300 else -3.0 if k % 1000 < 700 else 0.5) * LPM
        before = plant.pressure
        plant.advance(flow * 1e-3)
        given += 0.5 * (before + plant.pressure) * flow * 1e-3
    found = plant.state[0]
    assert found['relief_energy'] > 0.02 * found['pump_energy'] > 0.0
    stored, _ = quad(lambda p: p * supply.capacitance(p, record), 20.7e6, plant.pressure)
    throughput = found['pump_energy'] + found['relief_energy'] + abs(given)
    remainder = found['pump_energy'] - found['relief_energy'] - given - stored
    assert abs(remainder) < 1e-6 * throughput


@pytest.mark.parametrize('exponent', [1.0, 1.0 + 1e-9, 1.4, 1.7])
@pytest.mark.parametrize(('low', 'high'), [(0.0, 9e6), (13e6, 30e6), (5e6, 20e6)])
def test_stored_energy_is_the_integral_of_pressure_and_capacitance(exponent, low, high):
    """E9: of C7, below precharge, above it and through it."""
    record = supply.supply_record(replace(SHEET, polytropic_exponent=exponent))[0]
    expected = quad(lambda p: p * supply.capacitance(p, record), low, high, points=[12e6],
                    epsabs=0.0, epsrel=1e-12)[0]
    assert stored_energy(high, record) - stored_energy(low, record) == (
        pytest.approx(expected, rel=1e-9, abs=0.0))


def remainder(row: np.void, pump: float) -> float:
    """Return what is left of the account of a supply, E9, over its throughput."""
    used = [row[name] for name in ('energy', 'relief_energy', 'return_energy', 'stored_energy')]
    return float(abs(pump + row['held_energy'] - sum(used)) / (pump + sum(map(abs, used))))


def test_the_account_of_a_soft_supply_closes():
    """E9: with ripple, relief, a leak, a return line with a volume, and a tank under pressure."""
    sheet = replace(SHEET, return_pressure_mpa=0.2, return_line=LINE,
                    line_leakage_lpm_per_mpa=0.02)
    plant = supply.Supply(sheet, MS, SLOPE)
    for k in range(3300):
        flow = (14.0 if k % 1000 < 300 else -3.0 if k % 1000 < 700 else 0.5) * LPM
        plant.advance(flow * 1e-3, (9.0 - k % 7) * LPM * 1e-3)
    row = plant.state[0]
    assert abs(row['held_energy']) > 1e-5 * row['energy']
    for name in ('relief_energy', 'return_energy', 'pump_energy'):
        assert row[name] > 1.0, name
    assert abs(row['stored_energy']) > 100.0
    # RK4 of 0.1 ms across the knees of pump, relief valve and gas
    assert remainder(row, row['pump_energy']) < 1e-6


def test_the_account_of_an_ideal_supply_closes():
    """E9: what comes back at the return pressure is lost in the tank; nothing is stored."""
    plant = supply.Supply(
        supply.ConstantSupply(pressure_mpa=20.7, return_pressure_mpa=0.5), MS, SLOPE)
    plant.advance(2e-6, 1e-6)
    plant.advance(1e-6, 1.5e-6)
    row = plant.state[0]
    assert row['return_energy'] == pytest.approx(1.25, rel=1e-12, abs=0.0)
    assert row['stored_energy'] == row['held_energy'] == 0.0
    assert remainder(row, row['pump_energy']) < 1e-15


def test_what_a_pressure_held_over_a_tick_adds_is_booked():
    """E9: at 20.7 MPa paid, while the line falls by Q H/C: half of that times the volume."""
    sheet = replace(SHEET, pump_flow_lpm=0.0, gas_volume_l=1e-9)
    plant = supply.Supply(sheet, MS, 1e-16)
    drawn, c = 1e-9, 0.2e-3 / 7e8
    plant.advance(drawn)
    fallen = 20.7e6 - plant.pressure
    assert fallen == pytest.approx(drawn / c, rel=1e-5, abs=0.0)
    # of the gas there is less than 1e-5 of the line's capacitance
    assert plant.state['held_energy'][0] == pytest.approx(0.5 * fallen * drawn, rel=1e-4, abs=0.0)
    assert plant.state['stored_energy'][0] == pytest.approx(
        -(20.7e6 - 0.5 * fallen) * drawn, rel=1e-9, abs=0.0)


def test_the_energy_given_is_that_of_the_oil_at_both_pressures():
    """E1 of the actuators: 20.7 MPa drawn, 0.5 MPa returned, in ticks of 1 ms."""
    sheet = supply.ConstantSupply(pressure_mpa=20.7, return_pressure_mpa=0.5)
    plant = supply.Supply(sheet, MS, SLOPE)
    plant.advance(2e-6, 1e-6)
    plant.advance(1e-6, 1e-6)
    found = plant.state[0]
    assert found['energy'] == pytest.approx(62.1 - 1.0, rel=1e-12, abs=0.0)
    assert found['power'] == pytest.approx(20.2e3, rel=1e-12, abs=0.0)
    assert found['peak_power'] == pytest.approx(40.9e3, rel=1e-12, abs=0.0)
    assert found['pump_energy'] == pytest.approx(62.1, rel=1e-12, abs=0.0)
