"""Tolerance files: their meaning, and refusals with file, key and value."""

from isa_ros.errors import ConfigError
from isa_ros.replay.tolerances import load_tolerances, Tolerance
import numpy as np
import pytest

TYPES = {
    '/hip/joint_states': 'sensor_msgs/msg/JointState',
    '/hip/load_cell': 'geometry_msgs/msg/WrenchStamped',
}


@pytest.fixture
def load(tmp_path):
    """Return a function that reads a tolerance text."""
    def read(text):
        path = tmp_path / 'tolerance.yaml'
        path.write_text(text)
        return load_tolerances(path, TYPES)

    return read


def test_number_is_absolute_for_every_element(load):
    tolerances = load('/hip/joint_states: {position: 0.5}')
    assert tolerances.of('/hip/joint_states', 'position[3]') == Tolerance(0.5, 0.0)
    assert tolerances.of('/hip/joint_states', 'velocity[3]') is None
    assert tolerances.of('/hip/load_cell', 'position[3]') is None


def test_index_wins_over_the_whole_array(load):
    tolerances = load('/hip/joint_states:\n  position: 0.5\n  "position[1]": 0.0\n')
    assert tolerances.of('/hip/joint_states', 'position[1]') == Tolerance(0.0, 0.0)
    assert tolerances.of('/hip/joint_states', 'position[0]') == Tolerance(0.5, 0.0)


def test_both_bounds_add_up(load):
    found = load('/hip/load_cell: {wrench.force.x: {absolute: 1.0, relative: 0.1}}')
    tolerance = found.of('/hip/load_cell', 'wrench.force.x')
    assert tolerance.bound(np.array([-100.0, 0.0])).tolist() == [11.0, 1.0]


def test_a_star_stands_for_all_that_is_not_named(load):
    """A topic and a field of their own come first."""
    tolerances = load("'*': {'*': {relative: 1.0e-9}}\n"
                      '/hip/joint_states: {position: 0.5}\n')
    joints, force = '/hip/joint_states', '/hip/load_cell'
    assert tolerances.of(joints, 'position[0]') == Tolerance(0.5, 0.0)
    for topic, field in ((joints, 'velocity[2]'), (force, 'wrench.force.x')):
        assert tolerances.of(topic, field) == Tolerance(0.0, 1e-9)
    assert tolerances.of(force, 'header.stamp.sec') is None
    of_one = load("/hip/load_cell: {'*': 2.0, wrench.force.x: 1.0}")
    assert of_one.of(force, 'wrench.torque.z') == Tolerance(2.0, 0.0)
    assert of_one.of(force, 'wrench.force.x') == Tolerance(1.0, 0.0)
    assert of_one.of(joints, 'position[0]') is None


@pytest.mark.parametrize('text, expected', [
    ("'*': {position: 1.0}", r"tolerance.yaml: \* = \{'position': 1.0\}, must be \{'\*': BOUND\}"),
    ("'*': 1.0", r'tolerance.yaml: \* = 1.0, must be'),
    ('/knee: {position: 1.0}',
     'tolerance.yaml: /knee: no such topic in the bag, which has /hip/joint_states, /hip/load'),
    ('/hip/load_cell: 1.0', 'tolerance.yaml: /hip/load_cell = 1.0, must be a section of fields'),
    ('/hip/load_cell: {wrench.force.w: 1.0}',
     'tolerance.yaml: /hip/load_cell: wrench.force.w: must be a float field of the message: wr'),
    ('/hip/load_cell: {header.stamp.sec: 1}', 'header.stamp.sec: must be a float field'),
    ('/hip/load_cell: {wrench.force.x: -1.0}',
     'wrench.force.x: absolute = -1.0, must be a finite number >= 0'),
    ('/hip/load_cell: {wrench.force.x: .inf}', 'absolute = inf, must be a finite number'),
    ('/hip/load_cell: {wrench.force.x: true}', 'absolute = True, must be a finite number'),
    ('/hip/load_cell: {wrench.force.x: {relative: a}}', "relative = 'a', must be a finite"),
    ('/hip/load_cell: {wrench.force.x: {}}', r'= \{\}, must be a number or have absolute and'),
    ('/hip/load_cell: {wrench.force.x: {rel: 1.0}}', r"\{'rel': 1.0\}, must be a number or have"),
    ('/hip/load_cell: {}\n/hip/load_cell: {}', 'duplicate key /hip/load_cell'),
])
def test_malformed_tolerance_is_refused(load, text, expected):
    with pytest.raises(ConfigError, match=expected):
        load(text)
