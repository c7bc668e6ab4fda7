"""The trot: feet that do not slip, a leg that reaches them, torques that carry the robot."""

from dataclasses import replace
import math
from pathlib import Path

from hypothesis import given, strategies as st
from isa_ros.errors import ConfigError
from isa_ros.scenario.trot import foot_at, leg_angles, TrotParameters, TrottingLeg
from isa_ros.surroundings.bodies.leg.dynamics import leg_terms
from isa_ros.surroundings.bodies.leg.sheet import body_record, STANDARD_GRAVITY
import numpy as np
import pytest
from tests.legs import leg_sheet

URDF = Path(__file__).resolve().parents[2] / 'urdf' / 'hyq_real_leg.urdf'
SHEET = leg_sheet()
BODY = body_record(SHEET.body)[0]
TROT = TrotParameters(forward_speed=1.0, step_frequency_hz=1.7, duty_factor=0.55, step_height=0.08,
                      hip_height=0.57, robot_mass=120.0)
LEG = TrottingLeg(TROT, SHEET)

strides = st.floats(0.0, 10.0)
trots = st.builds(
    TrotParameters, forward_speed=st.just(0.0) | st.floats(1e-9, 3.0),
    step_frequency_hz=st.floats(0.5, 4.0),
    duty_factor=st.floats(0.51, 0.9), step_height=st.just(0.0) | st.floats(1e-9, 0.2),
    hip_height=st.floats(0.3, 0.7), robot_mass=st.just(0.0) | st.floats(1e-9, 200.0))


def foot_of(stride: float) -> tuple[float, float, float, float]:
    """Return position and velocity of the foot by the leg's own forward kinematics (L8)."""
    joints = LEG.at(stride)
    terms = leg_terms(0.0, *joints.angle, 0.0, *joints.speed, BODY)
    return terms.foot_x, terms.foot_z, terms.foot_v_x, terms.foot_v_z


@given(part=st.floats(0.0, 0.549))
def test_a_standing_foot_goes_back_at_the_forward_speed(part: float) -> None:
    """On a straight line, x = L/2 - v t at 1 m/s; rounding of lengths and speeds below 10."""
    x, z, v_x, v_z = foot_of(part)
    assert x == pytest.approx(0.5 * 0.55 / 1.7 - part / 1.7, abs=1e-13)
    assert z == pytest.approx(-0.57, abs=1e-13)
    assert v_x == pytest.approx(-1.0, abs=1e-13)
    assert v_z == pytest.approx(0.0, abs=1e-13)


@given(trot=trots, stride=strides)
def test_the_foot_moves_as_its_derivatives_say(trot: TrotParameters, stride: float) -> None:
    """
    Central differences over 1e-5 of a stride against the speeds and accelerations given.

    Position and speed have no jump, so that this holds across lift-off and touch-down; the
    error is below the step times the largest acceleration, or jerk (G3: second and third
    derivatives of w below 6 and 60, of 64 u^3 (1 - u)^3 below 24 and 384).
    """
    e = 1e-5
    rate = trot.step_frequency_hz / (1.0 - trot.duty_factor)
    step = e / trot.step_frequency_hz
    size = 60.0 * trot.forward_speed / trot.step_frequency_hz + 384.0 * trot.step_height
    before, at, after = (foot_at(trot, stride + k * e) for k in (-1.0, 0.0, 1.0))
    # Rounding: positions to 1e-15 m, the stride (up to 10) to 2e-15 of its slope.
    noise = 1e-14 * (1.0 + size * rate * rate * rate) / step
    for name in 'xz':
        slope = (getattr(after, name) - getattr(before, name)) / (2.0 * step)
        bound = step * size * rate * rate + noise
        assert slope == pytest.approx(getattr(at, f'v_{name}'), abs=bound)
        slope = (getattr(after, f'v_{name}') - getattr(before, f'v_{name}')) / (2.0 * step)
        assert slope == pytest.approx(
            getattr(at, f'a_{name}'), abs=step * size * rate * rate * rate + noise)


@pytest.mark.parametrize('event', [0.0, 0.55, 1.0])
def test_lift_off_and_touch_down_have_no_jump(event: float) -> None:
    """
    Position, speed and acceleration within 1e-9 of a stride on both sides.

    Jerk is below 60 v/f rate^3 + 384 h rate^3 = 3600 m/s3: 2e-9/1.7 s of it is 4e-6 m/s2.
    """
    before, after = foot_at(TROT, event - 1e-9), foot_at(TROT, event + 1e-9)
    assert np.abs(np.subtract(before[:6], after[:6])).max() < 5e-6


def test_the_foot_swings_as_high_as_the_step() -> None:
    feet = [foot_at(TROT, k / 1000) for k in range(1000)]
    assert max(foot.z for foot in feet) == pytest.approx(-0.57 + 0.08, abs=1e-15)
    assert min(foot.z for foot in feet) == -0.57
    assert foot_at(TROT, 0.775).z == max(foot.z for foot in feet)


@given(trot=trots, stride=strides)
def test_the_weight_is_carried_at_any_time(trot: TrotParameters, stride: float) -> None:
    """
    Two feet of each diagonal pair, half a stride apart, carry m g together (G4).

    The two times differ in rounding, 2e-15 of a stride over an overlap of 0.01: 4e-13 of w.
    """
    pair, other = foot_at(trot, stride), foot_at(trot, stride + 0.5)
    weight = trot.robot_mass * STANDARD_GRAVITY
    assert 2.0 * (pair.load + other.load) == pytest.approx(weight, rel=1e-11, abs=1e-11)


@given(hfe=st.floats(math.radians(15.0), math.radians(125.0)),
       kfe=st.floats(math.radians(-158.7), math.radians(-38.4)))
def test_inverse_kinematics_undo_the_forward_kinematics(hfe: float, kfe: float) -> None:
    """G5 against L8; ulps of 1 m over the folded leg's 0.14 m and sin(KFE) > 0.36: 1e-14."""
    terms = leg_terms(0.0, 0.0, hfe, kfe, 0.0, 0.0, 0.0, 0.0, BODY)
    found = leg_angles(terms.foot_x, terms.foot_z, 0.36, 0.38)
    apart = (found[0] - hfe + math.pi) % (2.0 * math.pi) - math.pi  # atan2 may be a turn away
    assert apart == pytest.approx(0.0, abs=1e-13)
    assert found[1] == pytest.approx(kfe, abs=1e-13)


@given(stride=strides)
def test_joint_speeds_are_the_derivatives_of_the_angles(stride: float) -> None:
    """Central difference over 1e-5 of a stride each way, across lift-off and touch-down too."""
    e = 1e-5
    before, at, after = (LEG.at(stride + k * e) for k in (-1.0, 0.0, 1.0))
    slope = np.subtract(after.angle, before.angle) * (1.7 / (2.0 * e))
    # Truncation below (6e-6 s)^2/6 times 1e5 rad/s3 = 6e-7; rounding 1e-15/1.2e-5 s = 1e-10.
    assert np.abs(slope - at.speed).max() < 1e-6


@pytest.mark.parametrize('stride', [0.02, 0.1, 0.3, 0.52, 0.6, 0.7, 0.8, 0.9])
def test_torques_equal_inverse_dynamics_of_pinocchio(stride: float) -> None:
    """
    G6: rnea of the shipped URDF less J^T f, the accelerations from differences of the speeds.

    Over 1e-6 of a stride they are right to 1e-15 8/1.2e-6 s = 1e-8 rad/s2, inertias below 2.
    """
    pin = pytest.importorskip('pinocchio')
    model = pin.buildModelFromUrdf(str(URDF))
    model.gravity.linear = np.array([0.0, 0.0, -STANDARD_GRAVITY])
    joints, e = LEG.at(stride), 1e-6
    a = np.subtract(LEG.at(stride + e).speed, LEG.at(stride - e).speed) * (1.7 / (2.0 * e))
    data, q = model.createData(), np.array([0.0, *joints.angle])
    torque = pin.rnea(
        model, data, q, np.array([0.0, *joints.speed]), np.array([0.0, *a]))
    jacobian = pin.computeFrameJacobian(
        model, data, q, model.getFrameId('foot'), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    torque -= jacobian[2] * foot_at(TROT, stride).load
    assert np.abs(torque[1:] - joints.torque).max() < 1e-6


def test_hfe_moves_as_far_as_the_rig_is_asked_to() -> None:
    """0.35 rad at 1.7 Hz, the motion the torque of the rotary rig is judged by, to its digits."""
    hfe = [LEG.at(k / 400).angle[1] for k in range(400)]
    assert 0.5 * (max(hfe) - min(hfe)) == pytest.approx(0.35, abs=0.005)


@pytest.mark.parametrize('change, expected', [
    ({'forward_speed': 2.0}, 'forward_speed = 2 m/s at step_frequency_hz = 1.7 Hz moves hfe from '
                             '-8.345 to 66.79 deg, must stay within its 15 to 125 deg'),
    ({'forward_speed': 4.0}, 'm from the hip, must be 0.02 to 0.74 m, the reach of the leg'),
    ({'hip_height': 0.75}, 'm from the hip, must be 0.02 to 0.74 m'),
    ({'hip_height': 0.71, 'forward_speed': 0.1}, ' deg, must stay within its -158.7 to -38.4 deg'),
    ({'hip_height': 0.2}, 'moves kfe from'),
])
def test_a_trot_beyond_the_leg_is_refused(change: dict[str, float], expected: str) -> None:
    with pytest.raises(ConfigError) as caught:
        TrottingLeg(replace(TROT, **change), SHEET)
    assert expected in str(caught.value)
