"""Robots of run files in motion: where they begin, what is held, and when it is let go."""

import isa_ros
from isa_ros.config.robots.geometry import motion_of
import numpy as np
import pytest


def test_a_free_robot_is_held_where_its_start_says():
    """Turned by 90 deg, 50 mm above the ground, let go after 3 ms."""
    result = isa_ros.load('quadruped').replace({
        'body.start.height_mm': 50.0, 'body.start.x_mm': 100.0, 'body.start.y_mm': -200.0,
        'body.start.yaw_deg': 90.0, 'body.start.release_s': 0.003}).simulate(0.006)
    place = result['body.position']
    assert place[0] == pytest.approx([0.1, -0.2, 0.61701864], abs=1e-8)
    assert result['body.orientation'][0] == (
        pytest.approx([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)], abs=1e-12))
    assert (place[:4] == place[0]).all()
    fallen = 0.5 * 9.80665 * 0.003 ** 2
    assert place[0][2] - place[6][2] == pytest.approx(fallen, rel=0.2)  # trunk and legs: no point
    foot = result['body.lf_foot_position'][0]       # at the front, 0.4435 m, is now at the left
    assert foot == pytest.approx([0.1 - 0.256, -0.2 + 0.4435, 0.05], abs=1e-5)


def test_a_passive_joint_is_held_until_the_release():
    """A load that does not hang below its pin."""
    result = isa_ros.load('crane').replace({
        'body.start.joints_deg.swing_pitch': 0.0, 'body.start.release_s': 0.003}).simulate(0.006)
    speed = result['body.swing_pitch_velocity']
    assert (speed[:4] == 0.0).all() and abs(speed[6]) > 1e-3


@pytest.mark.parametrize('name', ['crane', 'two_joint_leg'])
def test_the_levers_that_are_checked_are_those_that_push(name):
    """Of the checks before a run, and of the compiled robot at t = 0."""
    run = isa_ros.load(name)
    own, result = run.configuration.bodies[0], run.simulate(0.001)
    for drive in own.sheet.drives:
        _, levers = motion_of(own.sheet, drive, own.coordinates)
        lever = float(result[f'body.{drive.actuator}_lever'][0])
        assert len(levers) == 1 and abs(levers[0] - lever) < 1e-14


def test_a_fixed_root_is_where_its_start_says():
    """Half a metre ahead, 0.2 m up, turned by 90 deg: the load with it."""
    plain, moved = (isa_ros.load('crane').replace(changes).simulate(0.001) for changes in (
        {'body.start.x_mm': 0.0},
        {'body.start.x_mm': 500.0, 'body.start.height_mm': 200.0, 'body.start.yaw_deg': 90.0}))
    x, y, z = plain['body.load_bottom_position'][0]
    assert moved['body.load_bottom_position'][0] == pytest.approx(
        [0.5 - y, x, z + 0.2], abs=1e-12)
