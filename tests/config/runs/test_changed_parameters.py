"""Single parameters of an actuator replaced by their dotted paths."""

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.changed_parameters import with_parameters
from isa_ros.config.runs.run_file import load_run
from isa_ros.errors import ConfigError, ParameterError
import pytest

WHERE = 'rig_rotary.yaml'


@pytest.fixture(scope='module')
def rotor():
    """Return the actuator of the shipped rotary rig."""
    return load_run(find('rig_rotary', CONFIG)).actuators[0]


def test_a_parameter_of_the_load_and_a_whole_section_are_replaced(rotor):
    oil = rotor.sheet.plant.oil
    changed = with_parameters(rotor, {'load.inertia': 0.5, 'plant.oil': oil}, WHERE)
    assert changed.load.inertia == 0.5 != rotor.load.inertia
    assert changed.sheet == rotor.sheet


def test_only_the_named_parameter_changes(rotor):
    """In the unit of the data sheet; the actuator that was given stays as it is."""
    before = rotor.sheet.plant.sensors.adc_bits
    changed = with_parameters(rotor, {'plant.sensors.adc_bits': 10}, WHERE)
    assert changed.sheet.plant.sensors.adc_bits == 10 != before
    assert rotor.sheet.plant.sensors.adc_bits == before
    assert with_parameters(changed, {'plant.sensors.adc_bits': before}, WHERE) == rotor


@pytest.mark.parametrize('values, expected', [
    ({'plant.oil.dead_volume': 1.0}, r'rig_rotary\.yaml: rotor\.plant\.oil\.dead_volume is '
                                     'unknown; the key is dead_volume_ml'),
    ({'plant.oil.dead_volume_ml.x': 1.0}, 'dead_volume_ml is one value, has no x'),
    ({'load.mass': 1.0}, r'rotor\.load\.mass is unknown; valid: inertia')])
def test_an_unknown_parameter_is_named(rotor, values, expected):
    with pytest.raises(ConfigError, match=expected):
        with_parameters(rotor, values, WHERE)


def test_a_value_out_of_range_is_refused(rotor):
    with pytest.raises(ParameterError, match=r'rotor\.plant\.sensors\.adc_bits: .*must be >='):
        with_parameters(rotor, {'plant.sensors.adc_bits': 0}, WHERE)
