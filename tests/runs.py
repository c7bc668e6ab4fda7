"""Small runs as the tests need them: actuators on loads of their own, and what feeds them."""

from collections.abc import Sequence
from dataclasses import replace

from isa_ros.actuator.link import LinkSheet, NO_LINK
from isa_ros.config.runs.default_actuator import default_actuator
from isa_ros.config.runs.run_config import ActuatorConfig, RunConfig
from isa_ros.config.runs.supplies import SupplyConfig
from isa_ros.surroundings.return_line import VolumeReturn
from isa_ros.surroundings.supply import AccumulatorSupply, ConstantSupply

CONSTANT = ConstantSupply(pressure_mpa=20.7, return_pressure_mpa=0.0)
RETURN_LINE = VolumeReturn(oil_volume_l=0.5, bulk_modulus=1e9, tank_lpm_per_mpa=40.0)
ACCUMULATOR = AccumulatorSupply(
    pressure_mpa=20.7, return_pressure_mpa=0.0, gas_volume_l=0.32, precharge_mpa=12.0,
    polytropic_exponent=1.3, line_volume_l=0.5, bulk_modulus=1.0e9, pump_flow_lpm=12.0,
    pump_lag_s=0.03, pump_band_mpa=0.5, relief_mpa=22.5, relief_lpm_per_mpa=10.0)
BUS = replace(
    NO_LINK, kind='ethercat', cycle_ms=1.0, delay_cycles=1.0, jitter_us=200.0, loss=0.1,
    watchdog_ms=10.0)


def run_of(
        *actuators: ActuatorConfig, supplies: Sequence[SupplyConfig] | None = None,
        controllers: Sequence[str] = ()) -> RunConfig:
    """Return a run of some actuators on a constant supply, or on ``supplies``."""
    if supplies is None:
        supplies = [SupplyConfig('supply', CONSTANT, tuple(own.name for own in actuators))]
    return RunConfig(
        'rig', 1_000_000, 120_000, 5.0, tuple(supplies), actuators, (), tuple(controllers),
        'rig.yaml')


def hip_and_knee(
        supplies: Sequence[SupplyConfig] | None = None, link: LinkSheet = NO_LINK) -> RunConfig:
    """Return a run of a rotary and a linear actuator."""
    actuators = (default_actuator('smart_manifold', 'hip'), default_actuator('isa_v5', 'knee'))
    return run_of(*(replace(own, sheet=replace(own.sheet, link=link)) for own in actuators),
                  supplies=supplies)
