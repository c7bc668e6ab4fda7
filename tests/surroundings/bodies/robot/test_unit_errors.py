"""What may change of a robot: pushes on a free root, errors of the units that can fail."""

from isa_ros.core.changeable import changeables
from isa_ros.surroundings.bodies.robot.sheet import Push
from isa_ros.surroundings.bodies.robot.unit_errors import changing_values
from isa_ros.surroundings.inertial_unit import UnitErrors

ERRORS = UnitErrors(accelerometer_sigma=0.1, accelerometer_bias=0.2, gyro_sigma=0.3,
                    gyro_bias=0.4, scale=0.9)


def test_a_fixed_root_with_a_unit_has_its_errors_and_no_push() -> None:
    found = changing_values(False, {'boom': ERRORS, 'base': ERRORS})
    assert found is not None
    names = list(changeables(found))
    assert len(names) == 14 and not [name for name in names if name.startswith('push')]
    assert {name.rpartition('.')[0] for name in names} == {'imus.boom', 'imus.base'}


def test_a_free_root_has_both() -> None:
    found = changing_values(True, {'boom': ERRORS})
    assert found is not None and len(changeables(found)) == 13
    assert changeables(found)['imus.boom.gyro_bias'].value == 0.4


def test_without_such_units_it_is_as_before() -> None:
    assert changing_values(True, {}) == Push() and changing_values(False, {}) is None
