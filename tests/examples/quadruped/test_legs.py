"""The legs of the quadruped: places, speeds, Jacobians and weights of its links."""

from dataclasses import replace

import isa_ros
from isa_ros.errors import ConfigError
from isa_ros.examples.quadruped.legs import Legs
from isa_ros.examples.quadruped.trot import attitude_error, rotation
import numpy as np
import pytest

RNG = np.random.default_rng(1)


@pytest.fixture(scope='module')
def sheet():
    return isa_ros.load('quadruped').configuration.body('body').sheet


def updated(sheet, quaternion, turning, angles, speeds) -> Legs:
    legs = Legs(sheet)
    legs.update(rotation(quaternion), turning, angles, speeds)
    return legs


def drawn():
    quaternion = RNG.normal(size=4)
    return (quaternion / np.linalg.norm(quaternion), RNG.normal(size=3),
            RNG.uniform(-1.0, 1.0, 12), RNG.normal(size=12))


def turned(quaternion: np.ndarray, turning: np.ndarray, seconds: float) -> np.ndarray:
    """Return the quaternion after a short turn in world axes."""
    w, *v = quaternion
    v, turn = np.array(v), 0.5 * seconds * turning
    new = np.concatenate([[w - turn @ v], v + w * turn + np.cross(turn, v)])
    return new / np.linalg.norm(new)


def test_feet_are_where_the_body_has_them():
    """Of the sample at t = 0, whose tree is another kernel."""
    run = isa_ros.load('quadruped')
    simulation = run.simulation()
    sheet, body = run.configuration.body('body').sheet, simulation.body_sample
    legs = updated(sheet, body.orientation, np.zeros(3), np.array([
        body[f'{joint.name}_position'] for joint in sheet.joints]), np.zeros(12))
    for foot, place in zip(legs.feet_of, legs.feet):
        assert place + body.position == pytest.approx(
            body[f'{foot.name}_position'], abs=1e-12)


def test_speeds_and_jacobians_are_slopes_of_the_places(sheet):
    """Central differences of 1e-6 s: error of second order, and 1e-16/1e-6 of rounding."""
    quaternion, turning, angles, speeds = drawn()
    legs = updated(sheet, quaternion, turning, angles, speeds)
    before, after = (updated(sheet, turned(quaternion, turning, dt), turning,
                             angles + dt * speeds, speeds).feet for dt in (-1e-6, 1e-6))
    assert legs.velocities == pytest.approx((after - before) / 2e-6, abs=1e-7)
    for leg, path in enumerate(legs.paths):
        for k, link in enumerate(path):
            moved = angles.copy()
            moved[link - 1] += 1e-6
            feet = updated(sheet, quaternion, turning, moved, speeds).feet
            slope = (feet[leg] - legs.feet[leg]) / 1e-6
            assert legs.jacobians[leg, :, k] == pytest.approx(slope, abs=2e-6)


def test_holding_torques_are_slopes_of_the_height_of_the_centre_of_mass(sheet):
    """tau_j = d(m g z) / dq_j."""
    quaternion, turning, angles, speeds = drawn()
    legs = updated(sheet, quaternion, turning, angles, speeds)
    for joint in range(12):
        heights = []
        for step in (-1e-5, 1e-5):
            moved = angles.copy()
            moved[joint] += step
            heights.append(updated(sheet, quaternion, turning, moved, speeds).com[2])
        slope = sheet.mass * 9.80665 * (heights[1] - heights[0]) / 2e-5
        assert legs.holding[joint] == pytest.approx(slope, abs=1e-6)


def test_the_inertia_is_that_of_all_links_about_their_centre(sheet):
    """Of a body that only turns about it, 2 T = w' I w, with the links as points and boxes."""
    quaternion, turning, angles, _ = drawn()
    legs = updated(sheet, quaternion, turning, angles, np.zeros(12))
    inertia = legs.inertia(sheet)
    assert inertia == pytest.approx(inertia.T, abs=1e-12)
    assert np.linalg.eigvalsh(inertia).min() > 0.0
    points = sum(link.mass * np.sum(np.square(
        legs.origins[i] + legs._frames[i] @ np.array(link.com) - legs.com))
        for i, link in enumerate(sheet.links))
    own = sum(sum(link.inertia[:3]) for link in sheet.links)
    assert np.trace(inertia) == pytest.approx(2.0 * points + own, rel=1e-12, abs=0.0)


def test_a_leg_has_three_turning_joints(sheet):
    foot = next(own for own in sheet.contacts if own.is_foot)
    thigh = sheet.links[foot.link].parent
    contacts = tuple(replace(own, link=thigh) if own is foot else own for own in sheet.contacts)
    with pytest.raises(ConfigError, match=rf'{foot.name}: its leg has 2 joints'):
        Legs(replace(sheet, contacts=contacts))
    others = tuple(own for own in sheet.contacts if own is not foot)
    with pytest.raises(ConfigError, match='^number of feet = 3, must be 4$'):
        Legs(replace(sheet, contacts=others))


def test_the_error_of_the_attitude_is_the_turn_from_level():
    heading = np.array([0.8, 0.6])
    level = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
    assert attitude_error(level, heading) == pytest.approx(np.zeros(3), abs=1e-15)
    turn = np.array([2e-4, -3e-4, 1e-4])
    x, y, z = turn
    small = np.eye(3) + np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    # Of second order in the turn, 4e-4.
    assert attitude_error(small @ level, heading) == pytest.approx(turn, abs=2e-7)
