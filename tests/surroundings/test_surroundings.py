"""Supply and leg of a run: what they show, and that a saved one goes on byte for byte."""

from dataclasses import replace
import math
from pathlib import Path

from isa_ros.config.run_config import RunConfig
from isa_ros.config.run_file import load_run
from isa_ros.errors import ConfigError
from isa_ros.run.exchange import Rows
from isa_ros.surroundings.supply import AccumulatorSupply
from isa_ros.surroundings.surroundings import SharedLoad
import numpy as np
import pytest

CONFIG = Path(__file__).parents[2] / 'config'
ACCUMULATOR = AccumulatorSupply(
    pressure_mpa=20.7, return_pressure_mpa=0.0, gas_volume_l=0.32, precharge_mpa=12.0,
    polytropic_exponent=1.3, line_volume_l=0.5, bulk_modulus=1.0e9, pump_flow_lpm=12.0,
    pump_lag_s=0.03, pump_band_mpa=0.5, relief_mpa=22.5, relief_lpm_per_mpa=10.0)


@pytest.fixture(scope='module')
def leg() -> RunConfig:
    """Return the leg on a pump with an accumulator."""
    return replace(load_run(CONFIG / 'leg.yaml'), supply=ACCUMULATOR)


def moved(load: SharedLoad, rows: Rows, ticks: int) -> list[bytes]:
    """Return everything the load says in some ticks under constant forces and flow."""
    said = []
    for _ in range(ticks):
        load.ports(rows.ports)
        load.advance(rows.replies)
        load.show(rows.shared)
        said += [rows.ports.tobytes(), rows.shared.tobytes(), *map(bytes, load.messages(0))]
    return said


def test_a_restored_load_goes_on_byte_for_byte(leg):
    """Leg, pump and accumulator; also in an object that never moved."""
    load, rows = SharedLoad(leg), Rows(3)
    rows.replies['mean_forces'] = load.starts(leg)['force'][:, None]
    rows.replies['supply_volume'] = 1e-5
    moved(load, rows, 20)
    saved = load.snapshot()
    rest = moved(load, rows, 20)
    load.restore(saved)
    assert moved(load, rows, 20) == rest
    other = SharedLoad(leg)
    other.restore(saved)
    assert moved(other, rows, 20) == rest


def test_another_load_is_refused(leg):
    rig = SharedLoad(load_run(CONFIG / 'rig_rotary.yaml'))
    with pytest.raises(ConfigError, match=r'saved state of the load: \d+ bytes, must be 24'):
        rig.restore(SharedLoad(leg).snapshot())


def test_what_a_controller_is_shown_of_the_leg(leg):
    """The joints where the leg starts; NaN where there is no leg."""
    rows = Rows(3)
    SharedLoad(leg).show(rows.shared)
    assert rows.shared['supply_pressure'][0] == 20.7e6
    start = leg.leg.start
    expected = [start.angle(joint) for joint in ('haa', 'hfe', 'kfe')]
    assert rows.shared['joint_position'][0].tolist() == expected
    SharedLoad(load_run(CONFIG / 'rig_rotary.yaml')).show(rows.shared)
    assert math.isfinite(rows.shared['supply_pressure'][0])
    assert np.isnan(rows.shared['joint_position']).all()
    assert np.isnan(rows.shared['foot_force']).all()
