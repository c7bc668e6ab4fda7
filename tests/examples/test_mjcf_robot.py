"""Two actuators on hinges of an MJCF robot, which is written as those of MuJoCo Menagerie."""

from pathlib import Path

import isa_ros
from isa_ros.errors import ConfigError
import numpy as np
import pytest

mujoco = pytest.importorskip('mujoco', reason='no wheel for this Python')
from isa_ros.examples.mjcf_robot import (  # noqa: E402, I100
    ACTUATORS, main, MOVE, moved, robot, with_motors)

ARM = """<mujoco model="arm">
  <compiler angle="radian" autolimits="true"/>
  <option integrator="implicitfast"/>
  <default><default class="arm">
    <joint axis="0 1 0" range="-3.1 3.1" armature="0.1"/>
    <general gaintype="fixed" biastype="affine" ctrlrange="-3.1 3.1" gainprm="2000"
      biasprm="0 -2000 -400" forcerange="-150 150"/>
  </default></default>
  <worldbody><body pos="0 0 1" childclass="arm">
    <joint name="lift"/><geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.05" mass="8"/>
    <body pos="0.4 0 0"><joint name="elbow"/>
      <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.04" mass="3"/>
      <body pos="0.4 0 0"><joint name="wrist"/>
        <geom type="capsule" fromto="0 0 0 0.1 0 0" size="0.03" mass="1"/>
      </body></body></body></worldbody>
  <actuator>
    <general class="arm" name="lift" joint="lift"/>
    <general class="arm" name="elbow" joint="elbow"/>
    <general class="arm" name="wrist" joint="wrist"/>
  </actuator>
  <keyframe><key name="home" qpos="-1.0 1.2 0.3" ctrl="-1.0 1.2 0.3"/></keyframe>
</mujoco>"""
JOINTS = dict(zip(ACTUATORS, ('lift', 'elbow')))


@pytest.fixture(scope='module')
def path(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return the file of the robot."""
    file = tmp_path_factory.mktemp('arm') / 'arm.xml'
    file.write_text(ARM)
    return str(file)


def test_its_servos_are_replaced_on_two_joints(path: str) -> None:
    model = with_motors(path, JOINTS)
    assert [model.actuator(k).name for k in range(model.nu)] == ['wrist', *ACTUATORS]
    assert model.opt.timestep == 2e-4
    assert model.opt.integrator == int(mujoco.mjtIntegrator.mjINT_RK4)


def test_it_starts_at_its_keyframe_and_its_other_joints_are_held(path: str) -> None:
    at = isa_ros.Mounting(
        ACTUATORS, np.arange(2), np.array([0.5, 0.7]), [True, True], 1e-3, 0)
    body = robot(path, JOINTS, at)
    assert body.motion(body.state, np.zeros(2)).position == pytest.approx([0.5, 0.7])
    torques = np.array([isa_ros.MechanismBody(body, at).sample[f'{name}_force'][0]
                        for name in ACTUATORS])
    still = body.motion(body.state, torques)
    assert still.acceleration == pytest.approx([0.0, 0.0], abs=1e-6)
    # The wrist's servo is at its place: its weight alone, 0.5 Nm at most, on 0.1 kg m2.
    assert abs(still.generalised[2]) < 10.0


def test_its_joints_follow_two_actuators(path: str) -> None:
    """To and fro by the amplitude, within half of it, under tens of Nm."""
    result = moved(path, JOINTS, 0.3)
    for name in ACTUATORS:
        place = result[f'body.{name}_position'] - result[f'body.{name}_position'][0]
        assert place.max() == pytest.approx(MOVE, rel=0.5)
        assert 3.0 < np.abs(result[f'body.{name}_force']).max() < 150.0
    assert not result.trips


@pytest.mark.parametrize(('joints', 'message'), [
    (('lift', 'elbo'), "arm.xml: has no joint 'elbo'; .*elbow"),
    (('lift',), '1 joints, must be 2')])
def test_joints_that_it_has_not_are_refused(
        path: str, joints: tuple[str, ...], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        main(path, *joints)


def test_a_file_that_is_none_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match='none.xml: '):
        with_motors(str(tmp_path / 'none.xml'), JOINTS)
