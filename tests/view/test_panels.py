"""The diagrams of a run: names of channels that a result has, with their units."""

import isa_ros
from isa_ros.view.panels import channels_of, groups_of, recorded, tree_of
from isa_ros.view.scene import scene_of
import pytest
from tests.view.test_scene import FOLDER


@pytest.mark.parametrize('name', ['leg', 'quadruped', 'crane', 'rig_linear', 'pump_station'])
def test_every_channel_is_a_number_of_a_result(name):
    run = isa_ros.load(name)
    result = run.simulate(0.001)
    groups = groups_of(run.configuration)
    for channel in channels_of(groups, scene_of(run.configuration, FOLDER)):
        column, _, place = channel.partition('[')
        values = result[column]
        assert (values.ndim == 1) == (not place)
        assert not place or int(place[:-1]) < values.shape[1]


def test_units_are_those_of_the_actuator():
    groups = {group.name: group for group in groups_of(isa_ros.load('leg').configuration)}
    assert list(groups) == ['haa', 'hfe', 'kfe', 'body']
    of = {name: {panel.title: panel.unit for panel in group.panels}
          for name, group in groups.items()}
    assert of['haa']['position'] == 'deg' and of['haa']['torque'] == 'Nm'
    assert of['kfe']['position'] == 'mm' and of['kfe']['force'] == 'N'
    position, force, pressure, spool, current = groups['kfe'].panels
    assert [own.scale for own in (position, force, pressure, spool, current)] == [
        1e-3, 1.0, 1e6, 1e-3, 1e-3]
    assert [own.signal for own in pressure.curves] == [
        'kfe.pressure_a', 'kfe.pressure_b', 'supply.pressure']
    assert [(own.signal, own.is_reference) for own in force.curves] == [
        ('kfe.force', False), ('kfe.force_reference', True)]
    assert groups['haa'].panels[0].scale == pytest.approx(0.0174532925)


def test_contacts_of_one_foot_have_axes_and_of_several_the_upward_force():
    leg, = (own for own in groups_of(isa_ros.load('leg').configuration) if own.name == 'body')
    assert [(own.label, own.signal) for own in leg.panels[0].curves] == [
        (axis, f'body.foot_force[{k}]') for k, axis in enumerate('xyz')]
    four = groups_of(isa_ros.load('quadruped').configuration)[-1].panels[0]
    assert [own.signal for own in four.curves] == [
        f'body.{foot}_foot_wrench[2]' for foot in ('lf', 'rf', 'lh', 'rh')]


def test_what_was_not_recorded_is_left_out():
    groups = groups_of(isa_ros.load('leg').configuration)
    kept = recorded(groups, {'kfe.force', 'haa.position_reference'})
    assert [(own.name, [panel.title for panel in own.panels]) for own in kept] == [
        ('haa', ['position']), ('kfe', ['force'])]
    tree = tree_of(kept, {'kfe.force': 4, 'haa.position_reference': 9})
    assert tree[1]['panels'] == [{'label': 'force, N', 'scale': 1.0, 'curves': [
        {'label': 'measured', 'channel': 4, 'dash': False}]}]
    assert tree[0]['panels'][0]['curves'][0]['dash'] is True
