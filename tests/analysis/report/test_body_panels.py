"""Panels of bodies, made of the fields of their samples."""

from collections.abc import Sequence
from typing import Any

import isa_ros
from isa_ros.analysis.report.body_panels import body_group
from isa_ros.analysis.signals.signals import Signal, Signals
from isa_ros.core.fields import Field
from isa_ros.surroundings.messages import columns, JointStates
import numpy as np
import pytest

T = np.arange(5) * 0.1


class Body:
    """A body with fields of a test's own."""

    name, kind, called = 'body', 'robot', 'the robot'
    joints = (('hip', 'ram'),)

    def __init__(self, *fields: Field, states: Sequence[JointStates] = ()) -> None:
        self.fields, self._states = fields, states

    def messages(self, step_ns: int) -> Sequence[JointStates]:
        return self._states


def group_of(*fields: Field, without: str = '', states: Sequence[JointStates] = ()) -> Any:
    rng = np.random.default_rng(7)
    run = isa_ros.load('rig_linear').configuration
    return body_group(Body(*fields, states=states), Signals(run, {
        f'body.{own.name}': Signal(T, rng.standard_normal((5, *own.shape)))
        for own in fields if own.name != without}, T, 'here'))


def test_a_vector_is_a_panel_with_a_curve_for_each_axis():
    panel, = group_of(Field('orientation', '1', '', (4,))).panels
    assert panel.label == 'orientation' and [own.label for own in panel.curves] == [*'wxyz']


def test_numbers_of_joints_are_named_as_the_messages_of_the_body_say():
    """A column of another field, and a joint behind them, have no part in it."""
    field = Field('position', 'rad', '', (2,))
    states = JointStates('/joint_states', ['boom_joint', 'arm_joint', 'slider'],
                         [*columns('position', 2), 'height'], [*columns('velocity', 2), 'speed'],
                         [])
    panel, = group_of(field, states=[states]).panels
    assert panel.label == 'joint position, deg' and [own.label for own in panel.curves] == [
        'BOOM', 'ARM']
    panel, = group_of(field).panels
    assert panel.label == 'position, deg' and [own.label for own in panel.curves] == ['0', '1']


def test_a_number_may_be_of_two_joints_or_of_none():
    """Of a mass that two actuators move, and of a wheel that no joint state has."""
    states = JointStates('/joint_states', ['left_joint', 'right_joint', 'arm'],
                         ['position[2]', 'position[2]', 'position[0]'], [], [])
    panel, = group_of(Field('position', 'rad', '', (3,)), states=[states]).panels
    assert [own.label for own in panel.curves] == ['ARM', '1', 'LEFT, RIGHT']


def test_the_port_of_an_actuator_is_no_joint():
    """Its message has the form of joint states, on a topic of its own."""
    port = JointStates('/ram/load_port', ['ram', 'ram/acceleration'], ['port_x0[0]', 'port_a0[0]'],
                       [], [])
    panel, = group_of(Field('port_x0', 'm', '', (2,)), states=[port]).panels
    assert panel.label == 'port x0, m' and [own.label for own in panel.curves] == ['0', '1']


def test_joints_of_two_units_are_in_the_panels_of_theirs():
    states = JointStates('/r1/joint_states', ['slide', 'turn_joint'],
                         ['position[0]', 'position[1]'], [], [])
    slide, turn = group_of(Field('position', 'm, rad', '', (2,)), states=[states]).panels
    assert [own.label for own in slide.curves] == ['SLIDE']
    assert [own.label for own in turn.curves] == ['TURN']


def test_two_units_are_two_panels():
    """A wrench: force first, then its moment about the frame."""
    group = group_of(Field('lf_foot_wrench', 'N, Nm', '', (6,)))
    force, moment = group.panels
    assert (force.label, moment.label) == (
        'lf foot wrench, force, N', 'lf foot wrench, moment, Nm')
    assert not np.array_equal(force.curves[0].signal.values, moment.curves[0].signal.values)
    assert [own.label for own in moment.curves] == [*'xyz']
    assert group.sources == ['ram'] and (group.name, group.title) == ('robot', 'robot')


@pytest.mark.parametrize(('unit', 'shown', 'scale'), [
    ('rad', 'deg', np.pi / 180), ('rad/s', 'deg/s', np.pi / 180), ('m', 'm', 1.0)])
def test_angles_are_shown_in_degrees(unit, shown, scale):
    panel, = group_of(Field('hip_position', unit, '')).panels
    assert panel.unit == shown and panel.scale == pytest.approx(scale)


def test_a_few_joints_share_a_panel_and_many_are_apart_by_their_leg():
    few, = group_of(*(Field(f'{name}_position', 'rad', '') for name in 'abcdef')).panels
    assert few.title == 'joint position' and [own.label for own in few.curves] == [*'abcdef']
    many = group_of(*(Field(f'{leg}_{joint}_position', 'rad', '')
                      for leg in ('lf', 'rf', 'lh') for joint in ('haa', 'kfe', 'hfe'))).panels
    assert [[own.label for own in panel.curves] for panel in many] == [
        [f'{leg}_haa', f'{leg}_kfe', f'{leg}_hfe'] for leg in ('lf', 'rf', 'lh')]
    chain = group_of(*(Field(f'{name}_position', 'rad', '') for name in 'abcdefgh')).panels
    assert [len(panel.curves) for panel in chain] == [6, 2]


def test_joints_come_before_contacts_and_those_before_all_others():
    group = group_of(Field('height', 'm', ''), Field('foot_force', 'N', '', (3,)),
                     Field('hip_torque', 'Nm', ''), Field('knee_torque', 'Nm', ''))
    assert [own.title for own in group.panels] == ['joint torque', 'foot force', 'height']
    assert 'touch-down' in group.panels[1].caption


def test_what_was_not_recorded_is_left_out():
    group = group_of(Field('height', 'm', ''), Field('speed', 'm/s', ''), without='speed')
    assert [own.title for own in group.panels] == ['height']
