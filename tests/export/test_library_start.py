"""Starts of an instance of a library: its ranges, and the bytes of Python."""

import ctypes

from isa_ros.errors import ConfigError
from isa_ros.export.chosen import choose
from isa_ros.export.exported import exported
import numpy as np
import pytest
from tests.export.calls import (
    BEYOND_RANGE, NO_INSTANCE, NOT_FINITE, parameter, port, PRESSURES, started)
from tests.export.libraries import BEHIND, Instance, Loaded, written

pytestmark = pytest.mark.slow


def test_starts(loaded):
    instance = Instance(loaded)
    before = instance.save().tobytes()
    for k in range(4):
        numbers = [0.05, 10.0, 20e6, 1e5]
        numbers[k] = [np.nan, np.inf, -np.inf, np.nan][k]
        assert instance.start(*numbers) == NOT_FINITE
    assert instance.start(-1e-9, 0.0, 20e6, 0.0) == BEYOND_RANGE
    assert instance.start(0.1 + 1e-9, 0.0, 20e6, 0.0) == BEYOND_RANGE
    for force in (-5500.0, 7988.0, 1e9, -1e300):
        assert instance.start(0.05, force, 20e6, 0.0) == BEYOND_RANGE
    assert instance.start(0.05, 0.0, 20e6, -101326.0) == BEYOND_RANGE
    assert instance.start(0.05, 0.0, -101326.0, -101325.0) == BEYOND_RANGE
    assert instance.start(0.05, 0.0, 1e5, 1.1e5) == PRESSURES
    assert instance.save().tobytes() == before
    assert instance.start(0.1, 0.0, 1e5, 1e5) == 0 and instance.start(0.0, 0.0, 2e7, 0.0) == 0
    assert instance.start(0.02, 500.0, 18e6, 2e5) == 0
    expected = started(choose('isa_v5', {'reu.force.kp': 9.5e-08}), 0.02, 500.0, 18e6, 2e5)
    assert instance.save().tobytes()[:-BEHIND] == expected.snapshot()
    assert instance.sample.tobytes() == expected.sample.tobytes()
    given = port(x0=0.02, supply_pressure=18e6, return_pressure=2e5)
    assert instance.tick(given) == 0
    expected.tick(given)
    assert instance.sample.tobytes() == expected.sample.tobytes()


def test_a_start_with_a_force_stays_at_rest_where_its_load_is(loaded):
    """The load is behind the spring of the sensor; the first tick has the force that is held."""
    stiffness = parameter(loaded.call(
        'find', b'plant.mechanics.sensor_stiffness', result=ctypes.c_void_p)).number
    instance, jolted = Instance(loaded), Instance(loaded)
    for each in (instance, jolted):
        assert each.start(0.03, 700.0, 20.7e6, 0.0) == 0
    place = instance.load_position
    assert place == 0.03 - 700.0 / stiffness and 0.03 - place > 1e-6
    assert instance.tick(port(x0=place)) == jolted.tick(port(x0=0.03)) == 0
    assert abs(instance.reply['mean_forces'][0] - 700.0) < 10.0
    assert abs(jolted.reply['mean_forces'][0] - 700.0) > 200.0
    assert instance.load_position == place


def test_the_load_moves_as_its_port_says(loaded):
    instance = Instance(loaded)
    assert instance.load_position == 0.05
    assert instance.tick(port(v0=0.02)) == 0
    assert abs(instance.load_position - 0.05002) < 1e-12
    assert instance.tick(port(x0=0.05002, a_bias=3.0)) == 0
    assert abs(instance.load_position - 0.0500215) < 1e-12


def test_only_a_load_of_its_own_needs_no_port(loaded, tmp_path):
    instance = Instance(loaded)
    before = bytes(instance.memory)
    assert instance.tick() == NO_INSTANCE and bytes(instance.memory) == before
    chosen = choose('rig_linear')
    own = Loaded(written(exported(chosen), tmp_path), 'isa_ram')
    ram, other = Instance(own), Instance(own)
    assert ram.start(0.04, 0.0, 17e6, 3e5) == other.start(0.04, 0.0, 17e6, 3e5) == 0
    assert ram.save().tobytes()[:-BEHIND] == started(chosen, 0.04, 0.0, 17e6, 3e5).snapshot()
    for _ in range(3):
        assert ram.tick() == other.tick(port(x0=9.0, supply_pressure=17e6,
                                             return_pressure=3e5)) == 0
    assert ram.sample['position'] == 0.04 and ram.save().tobytes() == other.save().tobytes()


def test_the_configured_start_may_be_beyond_the_stroke(tmp_path):
    """A body may push so; setpoints and starts of a caller may not be there."""
    own = exported(choose('isa_v5'))
    own.start['position'] = 0.1 + 1e-5
    instance = Instance(Loaded(written(own, tmp_path), 'isa_v5'))
    assert abs(instance.sample['position'] - (0.1 + 1e-5)) < 1e-6
    assert instance.start(*own.start[0].item()) == BEYOND_RANGE
    assert instance.tick(port(x0=0.1)) == 0


def test_the_configured_force_may_be_beyond_the_relief_valves(tmp_path):
    own = exported(choose('isa_v5'))
    own.start['force'] = 8100.0
    instance = Instance(Loaded(written(own, tmp_path), 'isa_v5'))
    assert instance.start(0.05, 8100.0, 20.7e6, 0.0) == 0
    assert instance.start(0.05, 8101.0, 20.7e6, 0.0) == BEYOND_RANGE
    assert instance.start(0.05, -5500.0, 20.7e6, 0.0) == BEYOND_RANGE


def test_forces_of_a_start_are_those_of_python(loaded, own):
    """The ends of the range that `Run.actuators` has; those of an ISA v5 are not symmetric."""
    from isa_ros.config.runs.external_config import held_forces, refuse_force
    config, instance = own.chosen.config, Instance(loaded)
    low, high = held_forces(config)
    assert (round(low), round(high)) == (-5499, 7987)
    for force, beyond in ((low, -np.inf), (high, np.inf)):
        refuse_force(config, force)
        assert instance.start(0.05, force, 20.7e6, 0.0) == 0
        outside = float(np.nextafter(force, beyond))
        assert instance.start(0.05, outside, 20.7e6, 0.0) == BEYOND_RANGE
        with pytest.raises(ConfigError, match='relief valves open'):
            refuse_force(config, outside)
