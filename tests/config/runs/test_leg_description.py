"""The URDF of a run's leg: where its sensors are, what it is made of, and its shipped copies."""

import math
from pathlib import Path
from xml.etree import ElementTree

import isa_ros
from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.surroundings.bodies.leg.inertial import carried, link_motion, LINKS
from isa_ros.surroundings.bodies.leg.motion import ContinuousState, Coordinates
from isa_ros.surroundings.bodies.leg.sheet import body_record
from isa_ros.surroundings.linkage import actuator_coordinate
from isa_ros.surroundings.linkage_sheet import linkage_record
from isa_ros.surroundings.messages import Inertial
import numpy as np
import pytest
from scripts.write_urdf import texts
from tests.scripting.legs import two_legs

PLACE = (0.3, -0.02, 0.05)
IMUS = {link.removesuffix('_link'): dict(zip(('x_mm', 'y_mm', 'z_mm'), (300.0, -20.0, 50.0)),
                                         link=link) for link in LINKS}
ANGLES, SPEEDS = (0.2, 0.8, -1.5), (0.4, 1.5, -2.0, 3.0)
RATES = (0.7, -20.0, 35.0, -50.0)


def described(config='leg', **changes):
    """Return a run with four inertial units, and the URDF of its leg."""
    run = isa_ros.load(config).replace({'leg.imus': IMUS} | changes).configuration
    return run, run.description(run.leg, Path())


@pytest.fixture
def pin():
    return pytest.importorskip('pinocchio')


def test_the_shipped_files_are_those_of_the_shipped_runs():
    """Made by scripts/write_urdf.py."""
    found = list(texts())
    assert len(found) == 2
    for path, text in found:
        assert path.read_text(encoding='utf-8') == text


@pytest.mark.parametrize('config', ['leg', 'hyq_leg'])
@pytest.mark.parametrize('link', LINKS)
def test_an_inertial_unit_reads_the_motion_of_its_frame(pin, config, link):
    """Pinocchio's acceleration of the frame of the message, less g, and its turning  (L22)."""
    run, urdf = described(config)
    message = next(own for own in run.leg.messages(run.step_ns) if isinstance(own, Inertial)
                   and own.topic == f'/{link.removesuffix("_link")}/imu')
    model = pin.buildModelFromXML(urdf)
    data, frame = model.createData(), model.getFrameId(message.frame)
    assert frame < model.nframes
    q, v, a = np.array([0.7, *ANGLES]), np.array(SPEEDS), np.array(RATES)
    pin.forwardKinematics(model, data, q, v, a)
    turn = pin.updateFramePlacement(model, data, frame).rotation
    expected = pin.getFrameClassicalAcceleration(model, data, frame, pin.LOCAL).linear
    expected = expected + turn.T @ [0.0, 0.0, STANDARD_GRAVITY]
    body = body_record(run.leg.sheet.body)[0]
    state = ContinuousState(0.7, *ANGLES, *SPEEDS, 0.0, 0.0)
    force, w, w_rate = link_motion(LINKS.index(link), state, Coordinates(*RATES), body)
    # 1e-9: rounding of forces up to 100 m/s2 through three rotations
    assert carried(force, w, w_rate, PLACE) == pytest.approx(expected, abs=1e-9)
    assert w == pytest.approx(pin.getFrameVelocity(model, data, frame, pin.LOCAL).angular,
                              abs=1e-9)


@pytest.mark.parametrize('config', ['leg', 'hyq_leg'])
def test_a_load_cell_of_a_shaft_turns_about_z(pin, config):
    """Power by virtual work: torque.z in its frame is the torque of the joint."""
    _, urdf = described(config)
    model = pin.buildModelFromXML(urdf)
    data, q = model.createData(), np.array([0.7, *ANGLES])
    cell = pin.computeFrameJacobian(model, data, q, model.getFrameId('hip'), pin.WORLD)[3:, 1]
    pin.framesForwardKinematics(model, data, q)
    axis = data.oMf[model.getFrameId('haa_load_cell')].rotation[:, 2]
    assert cell == pytest.approx(axis, abs=1e-12)


def test_the_load_cell_of_the_knee_has_the_lever_of_its_linkage(pin):
    """In the middle of its range: x along the rod, from C to the end of the link B-R  (L5)."""
    run, urdf = described()
    sheet = run.leg.sheet.kfe
    model = pin.buildModelFromXML(urdf)
    data = model.createData()
    middle = math.radians(0.5 * (sheet.low_deg + sheet.high_deg))
    linkage = linkage_record(sheet)
    pin.framesForwardKinematics(model, data, np.array([0.0, 0.0, 0.0, middle]))
    thigh, cell, calf = (data.oMf[model.getFrameId(name)]
                         for name in ('thigh', 'kfe_load_cell', 'calf'))
    length = actuator_coordinate(middle, linkage)[0] + sheet.retracted_length_mm * 1e-3
    eye = cell.translation + length * cell.rotation[:, 0]
    theta = middle + math.radians(sheet.offset_deg)
    pin_b = calf.translation - thigh.rotation @ [
        sheet.bk_mm * 1e-3 * math.cos(theta), sheet.bk_mm * 1e-3 * math.sin(theta), 0.0]
    # L5: the link B-R has its length, so that R is the eye of the rod
    assert np.linalg.norm(eye - pin_b) == pytest.approx(sheet.br_mm * 1e-3, abs=1e-12)
    along = cell.rotation[:, 0] @ (calf.translation - cell.translation)
    assert along > 0.3      # towards the knee, which is 0.4 m from C


def test_the_lengths_of_the_run_are_drawn_and_collide():
    _, urdf = described(**{'leg.parameters.body.thigh.length_m': 0.4})
    robot = ElementTree.fromstring(urdf)
    for link in ('slider_link', 'hip', 'thigh', 'calf'):
        own = robot.find(f"link[@name='{link}']")
        shapes = [ElementTree.tostring(own.find(what)).split(b'>', 1)[1].rsplit(b'<', 1)[0]
                  for what in ('visual', 'collision')]
        assert shapes[0] == shapes[1] and b'geometry' in shapes[0]
    assert robot.find("link[@name='thigh']/visual/geometry/cylinder").get('length') == '0.4'
    assert robot.find("joint[@name='kfe_joint']/origin").get('xyz') == '0.4 0.0 0.0'


def test_an_actuator_that_turns_its_joint_backwards_has_the_same_torque():
    limits = []
    for changes in ({}, {'leg.parameters.haa.sense': -1.0, 'leg.parameters.haa.offset_deg': 40.0}):
        robot = ElementTree.fromstring(described(**changes)[1])
        limits.append(float(robot.find("joint[@name='haa_joint']/limit").get('effort')))
    assert limits[0] == limits[1] > 50.0


def test_two_legs_have_links_of_their_own():
    """Joints have the names of joint_states; links those of frames, only the world is shared."""
    run = isa_ros.load(two_legs()).configuration
    links, joints = [], []
    for leg in run.bodies:
        robot = ElementTree.fromstring(run.description(leg, Path()))
        links.append({link.get('name') for link in robot.iter('link')})
        joints.append({joint.get('name') for joint in robot.iter('joint')
                       if joint.get('type') != 'fixed'})
        assert f'{leg.name}/calf' in links[-1]
        children = [joint.find('child').get('link') for joint in robot.iter('joint')]
        assert {'world', *children} == links[-1] and len(set(children)) == len(children)
        assert {joint.find('parent').get('link') for joint in robot.iter('joint')} <= links[-1]
    assert links[0] & links[1] == {'world'} and joints[0] == joints[1]
