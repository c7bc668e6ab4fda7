"""The sheet of an accumulator with a pump."""

from isa_ros.surroundings import supply

SHEET = supply.AccumulatorSupply(
    pressure_mpa=20.7, return_pressure_mpa=0.0, gas_volume_l=0.32, precharge_mpa=12.0,
    polytropic_exponent=1.4, line_volume_l=0.2, bulk_modulus=7e8, pump_flow_lpm=12.0,
    pump_lag_s=0.03, pump_band_mpa=0.5, relief_mpa=22.5, relief_lpm_per_mpa=24.0)
MS = 1_000_000
SLOPE = 2e-12  # m3/s/Pa, of three valves wide open
