"""The scene of a run: every leg, robot and lone actuator, with what moves it."""

from dataclasses import replace
from pathlib import Path
from typing import ClassVar

import isa_ros
from isa_ros.config.runs.body_config import BodyConfig
from isa_ros.surroundings.messages import JointStates
from isa_ros.view.nodes import SceneMotion
from isa_ros.view.scene import scene_of
import pytest

FOLDER = Path(__file__).parents[2] / 'config'


def scene(name, folder=FOLDER):
    return scene_of(isa_ros.load(name).configuration, folder)


def test_a_leg_is_moved_by_its_joints_and_its_slider():
    nodes = scene('leg')
    moved = {node.name: node.channels for node in nodes if node.motion is not SceneMotion.FIXED}
    assert moved == {'slider_link': ('body.height',), 'hip': ('body.position[0]',),
                     'thigh': ('body.position[1]',), 'calf': ('body.position[2]',)}
    assert {node.name for node in nodes if node.shapes} == {
        'slider_link', 'hip', 'thigh', 'calf'}


def test_a_free_robot_moves_as_its_odometry_says():
    nodes = scene('quadruped')
    free, = (node for node in nodes if node.motion is SceneMotion.FREE)
    assert free.name == 'trunk' and list(free.channels) == [
        *(f'body.position[{k}]' for k in range(3)),
        *(f'body.orientation[{k}]' for k in range(4))]
    assert sum(node.motion is SceneMotion.TURN for node in nodes) == 12


@pytest.mark.parametrize('name', ['crane', 'two_joint_leg', 'hyq_quadruped', 'hyq_leg'])
def test_parents_stand_before_their_children(name):
    nodes = scene(name)
    assert all(node.parent < k for k, node in enumerate(nodes))
    assert sum(len(node.shapes) for node in nodes) >= 4


def test_lone_actuators_stand_side_by_side():
    """A cylinder moves its rod along x, a rotor lifts its arm."""
    nodes = scene('press')
    barrel, rod = nodes
    assert (rod.motion, rod.axis, rod.channels) == (
        SceneMotion.SLIDE, (1.0, 0.0, 0.0), ['slide.position'])
    stroke = isa_ros.load('press').configuration.actuators[0].sheet.plant.drive.stroke
    assert rod.reach == stroke == 0.25
    assert barrel.shapes[0].size[1] == pytest.approx(1.1 * stroke) and barrel.place[2] > 0.0
    # the eye is outside of the barrel over the whole stroke, the rod inside with its other end
    end = rod.shapes[0].place[0] - 0.5 * rod.shapes[0].size[1] + stroke
    assert 0.0 < end < 1.1 * stroke < rod.shapes[1].place[0]
    arm = scene('rig_rotary')[1]
    assert (arm.motion, arm.axis, arm.channels) == (
        SceneMotion.TURN, (0.0, -1.0, 0.0), ['rotor.position'])


def test_robots_stand_apart():
    run = isa_ros.load({'name': 'pair', 'robots': {
        'r1': {'file': 'leg'}, 'r2': {'file': 'two_joint_leg'}}}).configuration
    nodes = scene_of(run, FOLDER)
    assert [node.place.tolist() for node in nodes if node.parent < 0] == [
        [0.0, 0.0, 0.0], [0.0, 1.5, 0.0]]
    channels = [name for node in nodes for name in node.channels]
    assert 'r1.position[2]' in channels and 'r2.knee_position' in channels


def test_a_robot_whose_urdf_is_elsewhere_is_shown_by_its_actuators(tmp_path, monkeypatch):
    """Also where a file of that name is none."""
    run = isa_ros.load('crane').configuration
    (tmp_path / 'crane.urdf').write_text('no URDF')
    nodes = scene_of(run, tmp_path)
    assert [name for node in nodes for name in node.channels] == [
        'lift.position', 'tilt.position']
    assert nodes[0].place[1] < nodes[2].place[1]


class ArmConfig(BodyConfig):
    """A body of a kind that the package does not have; its URDF names the file's folder."""

    kind: ClassVar[str] = 'arm'
    has_urdf: ClassVar[bool] = True

    def messages(self, step_ns):
        return [JointStates('/joint_states', ['elbow'], ['angle'], ['speed'], [])]

    def description(self, sheets, folder, control=()):
        (name, sheet), = sheets.items()
        size = sheet.plant.drive.stroke
        return f"""<robot name="arm"><link name="{folder.name}"/><link name="{name}_arm">
            <visual><geometry><box size="{size} 0.1 0.1"/></geometry></visual></link>
            <joint name="elbow" type="revolute"><parent link="{folder.name}"/>
            <child link="{name}_arm"/><axis xyz="0 0 1"/></joint></robot>"""


def test_a_body_of_any_kind_is_shown_by_its_own_urdf(monkeypatch):
    run = isa_ros.load('press').configuration
    own = replace(run, bodies=(ArmConfig(joints=(('elbow', 'slide'),)),))
    root, arm = scene_of(own, FOLDER)
    assert (root.name, root.motion) == ('config', SceneMotion.FIXED)
    assert (arm.name, arm.motion, arm.channels) == (
        'slide_arm', SceneMotion.TURN, ('body.angle',))
    assert arm.shapes[0].size == pytest.approx((0.25, 0.1, 0.1))
    monkeypatch.setattr(ArmConfig, 'has_urdf', False)
    assert [node.name for node in scene_of(own, FOLDER)] == ['slide', 'slide']
