"""Supply: capacitance, steady state, refusal of one that is too small."""

from isa_ros.core.units import LPM
from isa_ros.errors import ParameterError
from isa_ros.surroundings import supply
import numpy as np
import pytest

SHEET = supply.AccumulatorSupply(
    pressure_mpa=20.7, return_pressure_mpa=0.0, gas_volume_l=0.32, precharge_mpa=12.0,
    polytropic_exponent=1.4, line_volume_l=0.2, bulk_modulus=7e8, pump_flow_lpm=12.0,
    pump_lag_s=0.03, pump_band_mpa=0.5, relief_mpa=22.5, relief_lpm_per_mpa=24.0)
MS = 1_000_000
SLOPE = 2e-12  # m3/s/Pa, of three valves wide open


def test_capacitance_is_the_slope_of_the_gas_volume():
    """C7: dV/dP of V_0 (p_0/P)^(1/n), by central difference, plus the line."""
    record = supply.supply_record(SHEET)[0]
    p_0, pressure, dp = 12.0e6 + supply.ATMOSPHERE, 20.0e6, 1e3

    def gas(p: float) -> float:
        return 0.32e-3 * (p_0 / (p + supply.ATMOSPHERE)) ** (1.0 / 1.4)
    slope = (gas(pressure - dp) - gas(pressure + dp)) / (2.0 * dp)
    line = 0.2e-3 / 7e8
    # the central difference itself errs by (dp/P)^2, far below 1e-6
    assert supply.capacitance(pressure, record) == pytest.approx(slope + line, rel=1e-6, abs=0.0)


def test_an_empty_accumulator_leaves_the_line():
    """C7 below precharge."""
    record = supply.supply_record(SHEET)[0]
    assert supply.capacitance(5e6, record) == pytest.approx(0.2e-3 / 7e8, rel=1e-15, abs=0.0)


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


def test_a_constant_supply_stays():
    """The ideal supply."""
    plant = supply.Supply(
        supply.ConstantSupply(pressure_mpa=20.7, return_pressure_mpa=0.1), MS, SLOPE)
    plant.advance(1.0)
    assert (plant.pressure, plant.return_pressure) == pytest.approx((20.7e6, 0.1e6))


def test_a_supply_too_small_for_the_tick_is_refused_with_both_numbers():
    """coupling.md: C over the valves' slope must last ten ticks."""
    with pytest.raises(ParameterError, match=r'must be >= 10 ms'):
        supply.Supply(SHEET, MS, flow_slope=1e-8)


def test_compiled_rates_equal_their_python_source():
    """The logarithm and exponential included."""
    record = supply.supply_record(SHEET)[0].tolist()
    row = np.array([record], supply.SUPPLY).view(np.recarray)[0]
    for pressure in np.linspace(1e6, 23e6, 200):
        assert supply.supply_rates(pressure, 1e-4, 5e-5, row) == \
            supply.supply_rates.py_func(pressure, 1e-4, 5e-5, row)
