"""Other values of what is measured: keys of the actuator and of its run file."""

from isa_ros.analysis.response.choice import Choice, chosen
from isa_ros.analysis.response.rig import Rig, rig
from isa_ros.errors import ConfigError
import pytest


def measured(name: str, **values: object) -> Rig:
    """Return the rig of a force loop; a double underscore stands for a dot."""
    return rig(Choice(name=name, loop='force', values={
        key.replace('__', '.'): value for key, value in values.items()}))


def test_a_model_and_the_same_model_in_a_run_file_have_the_same_keys():
    values = {'reu__force__kp': 9e-8, 'plant__oil__dead_volume_ml': 3.0}
    for name in ('isa_v5', 'rig_linear'):
        sheet = measured(name, **values).config.sheet
        assert (sheet.reu.force.kp, sheet.plant.oil.dead_volume_ml) == (9e-8, 3.0)


def test_keys_of_the_run_file_are_those_of_a_program():
    bench = measured('rig_linear', actuators__ram__parameters__reu__force__kp=9e-8,
                     supply__pressure_mpa=14.0)
    assert bench.config.sheet.reu.force.kp == 9e-8
    assert bench.run.supply_of('ram').pressure_mpa == 14.0
    assert measured('isa_v5', supply__pressure_mpa=14.0).run.supply_of(
        'isa_v5').pressure_mpa == 14.0


def test_a_kind_replaces_its_section():
    """ISA v5: the schedule of the preset has no parameters, nor has the other one."""
    shipped = measured('isa_v5').config.sheet.reu.force
    constant = measured('isa_v5', reu__force__gain_schedule__kind='constant').config.sheet
    assert type(constant.reu.force.gain_schedule) is not type(shipped.gain_schedule)
    assert constant.reu.force.kp == shipped.kp


def test_the_load_is_the_one_that_is_measured_on():
    """A force loop is blocked, a position loop keeps the mass of the file."""
    assert measured('rig_linear', load__stiffness=1e7).config.load.stiffness == 1e7
    bench = rig(Choice(name='rig_linear', loop='position', values={'load.inertia': 20.0}))
    assert bench.config.load.inertia == 20.0
    with pytest.raises(ConfigError, match='--load: inrtia is unknown'):
        measured('isa_v5', load__inrtia=1.0)


def test_a_preset_is_a_value_too():
    assert measured('isa_v5', preset='table_4').config.sheet == rig(
        Choice(name='isa_v5', loop='force', preset='table_4')).config.sheet


def test_the_title_has_the_values():
    assert 'reu.force.kp = 9e-08' in measured('isa_v5', reu__force__kp=9e-8).title


def test_the_tree_of_a_model_is_a_complete_run_file():
    named = chosen(Choice(name='isa_v2', loop='force', values={'reu.force.kp': 9e-8}))
    assert named.tree['actuators'] == {'isa_v2': {
        'model': 'isa_v2', 'preset': 'default', 'load': {'kind': 'mass'},
        'parameters': {'reu': {'force': {'kp': 9e-8}}}}}
    assert named.run.actuators[0].sheet.reu.force.kp == 9e-8
