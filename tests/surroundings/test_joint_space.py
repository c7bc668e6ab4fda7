"""Setpoints in joint space and those of the actuators: the same work, at the same place."""

import math

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.signals import HAS_SETPOINT
from isa_ros.errors import SetpointError
from isa_ros.surroundings.joint_space import to_actuator
from isa_ros.surroundings.linkage import actuator_coordinate
import numpy as np
import pytest
from tests.sheets import setpoint

STEP = 1e-6  # rad
ROUNDING = 1e-15  # of two operations, each half of 2.2e-16
JOINTS = load_run(find('leg', CONFIG)).leg.joint_space
SAMPLE = np.array(([-0.1, 0.7, -1.4],), [('position', 'f8', (3,))])
NOW = dict(zip(JOINTS, SAMPLE['position'].tolist()))


def converted(name, **values):
    command = setpoint(**values)
    to_actuator(name, JOINTS[name], SAMPLE[()], command)
    assert command['kinds'] == HAS_SETPOINT
    return command


@pytest.mark.parametrize('name', JOINTS)
def test_position_and_velocity_are_those_of_the_linkage(name):
    """A joint that turns for a moment moves its actuator by what the velocity says  (L2)."""
    angle = NOW[name] + 0.2
    here, there = (converted(name, position=angle + step, velocity=3.0)
                   for step in (-STEP, STEP))
    speed = (there['position'] - here['position']) / (2.0 * STEP) * 3.0
    assert converted(name, position=angle, velocity=3.0)['velocity'] == pytest.approx(
        speed, rel=1e-7, abs=0.0)
    assert here['position'] == actuator_coordinate(angle - STEP, JOINTS[name].linkage)[0]


@pytest.mark.parametrize('name', JOINTS)
def test_torque_and_gains_do_the_same_virtual_work(name):
    """T dq = F dx and K dq dq = k dx dx, dx = r dq, at the joint's present angle."""
    command = converted(
        name, position=NOW[name] + 0.2, effort=60.0, stiffness=300.0, damping=9.0)
    _, lever, _ = actuator_coordinate(NOW[name], JOINTS[name].linkage)
    assert command['effort'] * lever == pytest.approx(60.0, rel=ROUNDING, abs=0.0)
    assert command['stiffness'] * lever * lever == pytest.approx(300.0, rel=ROUNDING, abs=0.0)
    assert command['damping'] * lever * lever == pytest.approx(9.0, rel=ROUNDING, abs=0.0)


def test_what_is_not_given_stays_so():
    command = converted('kfe_joint', position=math.nan, effort=60.0)
    assert math.isnan(command['position']) and command['velocity'] == 0.0
    assert math.isnan(command['stiffness']) and math.isnan(command['damping'])


@pytest.mark.parametrize('name', JOINTS)
def test_an_angle_outside_the_range_of_the_joint_is_refused(name):
    """There the linkage may not be one: the ends themselves are accepted."""
    joint = JOINTS[name]
    for end, beyond in ((joint.low, -1e-9), (joint.high, 1e-9)):
        assert converted(name, position=end)['position'] is not None
        with pytest.raises(SetpointError, match=f'^{name}: setpoint position = .* rad, must be '):
            converted(name, position=end + beyond)
