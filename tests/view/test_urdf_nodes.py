"""A URDF as a tree of frames: places, axes, shapes; what moves, and what cannot be drawn."""

from isa_ros.errors import ConfigError
from isa_ros.view.nodes import SceneMotion, tree_of, WORLD
from isa_ros.view.urdf_nodes import Moved, urdf_nodes
import numpy as np
import pytest

ARM = """<robot name="arm">
  <joint name="lift" type="revolute"><parent link="foot"/><child link="boom"/>
    <origin xyz="0.1 0.2 0.3" rpy="0 0 1.5707963267948966"/><axis xyz="0 3 4"/></joint>
  <joint name="out" type="prismatic"><parent link="boom"/><child link="tip"/>
    <axis xyz="0 0 2"/></joint>
  <joint name="weld" type="fixed"><parent link="foot"/><child link="plate"/></joint>
  <link name="foot"/>
  <link name="boom"><visual><origin xyz="1 0 0" rpy="0 1.5707963267948966 0"/>
    <geometry><cylinder radius="0.04" length="2"/></geometry></visual>
    <visual><geometry><mesh filename="a.stl"/></geometry></visual></link>
  <link name="tip"><visual><geometry><sphere radius="0.06"/></geometry></visual></link>
  <link name="plate"><visual><geometry><box size="0.5 0.4 0.02"/></geometry></visual></link>
</robot>"""


def moved(root=(), **joints):
    return Moved(joints, root, np.array([0.0, 1.5, 0.0]))


def test_links_are_frames_below_their_parents():
    nodes = urdf_nodes(ARM, 'arm', moved(lift='body.lift', out='body.out'), 4)
    by_name = {node.name: node for node in nodes}
    assert nodes[0].name == 'foot' and nodes[0].parent == WORLD
    assert nodes[0].place.tolist() == [0.0, 1.5, 0.0]
    boom, tip, plate = (by_name[name] for name in ('boom', 'tip', 'plate'))
    assert boom.parent == plate.parent == 4 and nodes[tip.parent - 4] is boom
    assert boom.place.tolist() == [0.1, 0.2, 0.3]
    assert boom.rotation.tolist() == [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    assert (boom.motion, boom.axis, boom.channels) == (
        SceneMotion.TURN, [0.0, 0.6, 0.8], ('body.lift',))
    assert (tip.motion, tip.axis, tip.channels) == (
        SceneMotion.SLIDE, [0.0, 0.0, 1.0], ('body.out',))
    assert (plate.motion, plate.channels) == (SceneMotion.FIXED, ())


def test_shapes_have_place_and_size_and_meshes_are_left_out():
    nodes = {node.name: node for node in urdf_nodes(ARM, 'arm', moved(), 0)}
    cylinder, = nodes['boom'].shapes
    assert (cylinder.kind, cylinder.size) == ('cylinder', [0.04, 2.0])
    assert cylinder.place.tolist() == [1.0, 0.0, 0.0]
    assert (cylinder.rotation @ [0.0, 0.0, 1.0]).tolist() == [1.0, 0.0, 0.0]
    assert [(own.kind, own.size) for own in (*nodes['tip'].shapes, *nodes['plate'].shapes)] == [
        ('sphere', [0.06]), ('box', [0.5, 0.4, 0.02])]
    assert nodes['foot'].shapes == []


def test_a_joint_without_a_channel_rests_and_a_free_root_moves():
    pose = [f'body.pose[{k}]' for k in range(7)]
    nodes = urdf_nodes(ARM, 'arm', moved(pose), 2)
    assert [node.motion for node in nodes[:2]] == [SceneMotion.FIXED, SceneMotion.FREE]
    assert nodes[1].parent == 2 and nodes[1].channels == pose
    assert {node.motion for node in nodes[2:]} == {SceneMotion.FIXED}
    assert {node.parent for node in nodes[2:] if node.name in ('boom', 'plate')} == {3}


def test_a_joint_without_an_axis_turns_about_x():
    text = ARM.replace('<axis xyz="0 3 4"/>', '')
    boom = next(node for node in urdf_nodes(text, 'arm', moved(lift='a'), 0)
                if node.name == 'boom')
    assert (boom.motion, boom.axis) == (SceneMotion.TURN, [1.0, 0.0, 0.0])


def test_nodes_are_told_in_json_by_the_places_of_their_channels():
    nodes = urdf_nodes(ARM, 'arm', moved(lift='a', out='b'), 0)
    tree = {own['name']: own for own in tree_of(nodes, {'b': 5, 'a': 3})}
    assert tree['boom']['channels'] == [3] and tree['tip']['channels'] == [5]
    assert tree['boom']['motion'] == 'turn' and tree['tip']['motion'] == 'slide'
    assert tree['boom']['rotation'] == [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    assert tree['plate']['shapes'] == [{
        'kind': 'box', 'size': [0.5, 0.4, 0.02], 'place': [0.0, 0.0, 0.0], 'color': 0,
        'rotation': [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]}]


@pytest.mark.parametrize('old, new, message', [
    ('<link name="foot"/>', '', 'arm: has 0 links without a parent, must have one'),
    ('<link name="foot"/>', '<link name="foot"/><link name="b"/>', 'arm: has 2 links without'),
    ('child link="plate"', 'child link="boom"', 'arm: boom is the child of two joints'),
    ('child link="plate"', 'child link="pl"', 'arm: has 2 links'),
    ('radius="0.04"', 'radius="thick"', "arm: link boom: cylinder radius = 'thick', must be fin"),
    (' size="0.5 0.4 0.02"', '', 'link plate: box size = None, must be three numbers'),
    ('size="0.5 0.4 0.02"', 'size="0.5 0.4 0.02 1"', 'must be three numbers'),
    ('size="0.5 0.4 0.02"', 'size="0.5 0.4"', "link plate: box size = '0.5 0.4', must be three"),
    ('xyz="0.1 0.2 0.3"', 'xyz="0.1 inf 0.3"', 'arm: joint lift: origin xyz = '),
    ('xyz="0 3 4"', 'xyz="0 0 0"', 'arm: joint lift: axis xyz = 0 0 0'),
    ('<robot', '<!DOCTYPE x><robot', 'has a document type')])
def test_what_cannot_be_drawn_is_refused(old, new, message):
    with pytest.raises(ConfigError, match=message):
        urdf_nodes(ARM.replace(old, new), 'arm', moved(lift='a'), 0)
