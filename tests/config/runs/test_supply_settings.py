"""A relief valve below the compensator and a precharge above it are reported, not refused."""

import isa_ros
from isa_ros.config.paths import CONFIG, shipped
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.supply_settings import defeated_settings
from isa_ros.scenario.scenario import idle
import pytest

PUMP = {
    'kind': 'accumulator', 'pressure_mpa': 16.0, 'return_pressure_mpa': 0.0, 'gas_volume_l': 0.5,
    'precharge_mpa': 10.0, 'polytropic_exponent': 1.3, 'line_volume_l': 0.5, 'bulk_modulus': 1e9,
    'pump_flow_lpm': 20.0, 'pump_lag_s': 0.05, 'pump_band_mpa': 1.0, 'relief_mpa': 18.0,
    'relief_lpm_per_mpa': 10.0}


def lines(**changes: float) -> tuple[str, ...]:
    """Return what is said before a run of one ISA v5 on the pump with other values."""
    run = isa_ros.load({'name': 'own', 'supply': {**PUMP, **changes}, 'actuators': {
        'ram': {'model': 'isa_v5', 'load': {'kind': 'mass'}}}})
    return idle(run.configuration).warnings


def test_a_relief_valve_below_the_compensator() -> None:
    line, = lines(relief_mpa=12.0)
    assert line.endswith(
        'supply.relief_mpa = 12 MPa < supply.pressure_mpa = 16 MPa: the pump never reaches its '
        'pressure, its flow leaves through the relief valve')


def test_a_precharge_above_the_pump() -> None:
    line, = lines(precharge_mpa=20.0)
    assert line.endswith('supply.precharge_mpa = 20 MPa > supply.pressure_mpa = 16 MPa: the '
                         'accumulator takes no oil')


@pytest.mark.parametrize('changes', [
    {}, {'relief_mpa': 16.0}, {'precharge_mpa': 16.0}, {'relief_mpa': 12.0, 'pump_flow_lpm': 0.0}])
def test_what_works_says_nothing(changes: dict[str, float]) -> None:
    assert lines(**changes) == ()


def test_an_accumulator_of_a_circuit() -> None:
    """The pump of the station holds 20.7 MPa."""
    run = isa_ros.load('pump_station', changes={
        'supplies.station.parts.buffer.precharge_mpa': 25.0}).configuration
    line, = defeated_settings(run)
    held = run.supplies[0].sheet.pressure_mpa
    assert line == (
        f'station.parts.buffer.precharge_mpa = 25 MPa > {held:g} MPa of the pumps of station: '
        'the accumulator takes no oil')


def test_no_shipped_run_has_a_line() -> None:
    for path in shipped(CONFIG).values():
        assert list(defeated_settings(load_run(path))) == []
