"""Capacitance of an accumulator: the gas law counts absolute pressure, the line adds its own."""

from isa_ros.surroundings import supply
import numpy as np
import pytest

STANDARD_ATMOSPHERE = 101_325.0  # Pa
LINE = 0.2e-3 / 7e8              # m3/Pa, V/beta of the oil in the line
SHEET = supply.AccumulatorSupply(
    pressure_mpa=20.7, return_pressure_mpa=0.0, gas_volume_l=0.32, precharge_mpa=12.0,
    polytropic_exponent=1.4, line_volume_l=0.2, bulk_modulus=7e8, pump_flow_lpm=12.0,
    pump_lag_s=0.03, pump_band_mpa=0.5, relief_mpa=22.5, relief_lpm_per_mpa=24.0)


def record() -> np.void:
    """Return the `SUPPLY` record."""
    row: np.void = supply.supply_record(SHEET)[0]
    return row


def gas(pressure: float) -> float:
    """Return the volume of the gas at a gauge pressure, V_0 (p_0/P)^(1/n), in m3."""
    absolute, precharge = pressure + STANDARD_ATMOSPHERE, 12.0e6 + STANDARD_ATMOSPHERE
    return 0.32e-3 * float((precharge / absolute) ** (1.0 / 1.4))


@pytest.mark.parametrize('pressure', [12.1e6, 16e6, 20.7e6])
def test_capacitance_is_the_slope_of_the_gas_volume_at_absolute_pressure(pressure):
    """
    C7: -dV/dP by central difference, plus the line.

    The difference errs by (dp/P)^2 = 7e-9 and, of volumes of 3e-4 m3 rounded to 1e-16 of
    themselves, by 1e-16 P/dp = 2e-12. Gauge pressure in the gas law is 0.6 % off.
    """
    dp = 1e3
    slope = (gas(pressure - dp) - gas(pressure + dp)) / (2.0 * dp)
    assert supply.capacitance(pressure, record()) == pytest.approx(
        slope + LINE, rel=1e-8, abs=0.0)


def test_an_empty_accumulator_leaves_the_line():
    """C7 below precharge: two roundings of V/beta."""
    assert supply.capacitance(5e6, record()) == pytest.approx(LINE, rel=5e-16, abs=0.0)


def test_oil_that_is_drawn_is_oil_the_gas_and_the_line_gave():
    """
    C7, C8: without a pump worth the name the drawn volume is what gas and line expand by.

    A pump with a time constant of 10 s delivers less than q_max t^2/(2 T) = 9e-10 m3 in the
    0.1 s, of a volume of 1e-5 m3 that is drawn; RK4 is far below.
    """
    sheet = supply.AccumulatorSupply(
        pressure_mpa=20.7, return_pressure_mpa=0.0, gas_volume_l=0.32, precharge_mpa=12.0,
        polytropic_exponent=1.4, line_volume_l=0.2, bulk_modulus=7e8, pump_flow_lpm=0.1,
        pump_lag_s=10.0, pump_band_mpa=0.5, relief_mpa=22.5, relief_lpm_per_mpa=24.0)
    plant = supply.Supply(sheet, 1_000_000, flow_slope=2e-12)
    for _ in range(100):
        plant.advance(1e-7)
    given = gas(plant.pressure) - gas(20.7e6) + LINE * (20.7e6 - plant.pressure)
    pumped = 0.1e-3 / 60.0 * 0.1 ** 2 / (2.0 * 10.0)
    assert given == pytest.approx(1e-5, abs=pumped)
