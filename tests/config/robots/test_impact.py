"""The mass behind each contact, against Pinocchio; ticks too long for the ground of a robot."""

import math

import isa_ros
from isa_ros.config.paths import find_drawing
from isa_ros.config.robots.impact import contact_masses
from isa_ros.config.robots.start import root_pose
from isa_ros.scenario.scenario import idle
import numpy as np
import pinocchio as pin
import pytest


@pytest.mark.parametrize('name, frames', [
    ('quadruped', ['lf_foot', 'rh_foot', 'rf_calf']), ('two_joint_leg', ['foot'])])
def test_the_mass_behind_a_contact_is_pinocchios(name, frames):
    """A robot whose root is free and level, and one whose root is fixed and slides."""
    robot = isa_ros.load(name).configuration.body('body')
    sheet = robot.sheet
    free = [pin.JointModelFreeFlyer()] if sheet.is_free else []
    model = pin.buildModelFromUrdf(str(find_drawing(f'urdf/{robot.urdf}')), *free)
    data = model.createData()
    q = pin.neutral(model)
    for joint, value in zip(sheet.joints, robot.coordinates):
        q[model.joints[model.getJointId(joint.name)].idx_q] = value
    mass = pin.crba(model, data, q)
    mass = np.triu(mass) + np.triu(mass, 1).T
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    found = dict(zip([own.name for own in sheet.contacts], contact_masses(
        sheet, robot.coordinates, root_pose(robot.start, robot.tree, sheet.contacts))))
    for frame in frames:
        row = pin.getFrameJacobian(
            model, data, model.getFrameId(frame), pin.LOCAL_WORLD_ALIGNED)[2]
        assert found[frame] == pytest.approx(1.0 / (row @ np.linalg.solve(mass, row)), rel=1e-9)


def test_a_contact_that_cannot_move_has_no_bound():
    robot = isa_ros.load('two_joint_leg').replace({
        'body.contacts.rail': {'ground': 'metal', 'link': 'rail'}}).configuration.body('body')
    masses = contact_masses(
        robot.sheet, robot.coordinates, root_pose(robot.start, robot.tree, robot.sheet.contacts))
    by_name = dict(zip([own.name for own in robot.sheet.contacts], masses))
    assert by_name['rail'] == math.inf and math.isfinite(by_name['foot'])
    assert not robot.warnings(1_000_000)


def test_metal_under_a_foot_is_reported_before_a_run():
    run = isa_ros.load('two_joint_leg').replace({'body.contacts.foot.ground': 'metal'})
    line, = idle(run.configuration).warnings
    assert line.startswith(
        'two_joint_leg.yaml: on the ground of foot of the robot, stiffness = 1e+08 N/m^1.5, an '
        'impact lasts 1.7 ms, 1.7 ticks of step_ms = 1: ')
