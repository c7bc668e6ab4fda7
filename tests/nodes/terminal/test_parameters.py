"""Values of parameters as they are typed."""

from isa_ros.nodes.terminal.parameters import (
    _is_key, _parameter, needed_of, ParameterChange)
import pytest
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.parameter import Parameter


@pytest.mark.parametrize(('text', 'expected'), [
    ('2e-5', 2e-5), ('3e+4', 3e4), ('7', 7), ('0.5', 0.5), ('true', True), ('force', 'force'),
    ('[1.5, 2.5]', [1.5, 2.5])])
def test_a_number_without_a_point_is_a_number(text, expected):
    """YAML reads 2e-5 as a text."""
    found = _parameter(ParameterChange('reu.force.kp', text)).value
    assert found == expected and isinstance(found, type(expected))


SHARE = ParameterDescriptor(
    type=Parameter.Type.DOUBLE.value, description='share of the load, %',
    floating_point_range=[FloatingPointRange(from_value=0.5, to_value=12.0)])
COUNT = ParameterDescriptor(
    type=Parameter.Type.INTEGER.value, integer_range=[IntegerRange(from_value=-2, to_value=3)])


@pytest.mark.parametrize(('known', 'value', 'expected'), [
    (SHARE, 0.5, ''), (SHARE, 12, ''), (SHARE, 0.4, '0.5 to 12: share of the load, %'),
    (SHARE, 12.5, '0.5 to 12: share of the load, %'),
    (SHARE, float('nan'), '0.5 to 12: share of the load, %'),
    (SHARE, 'abc', 'a number: share of the load, %'),
    (SHARE, True, 'a number: share of the load, %'),
    (SHARE, [1.0], 'a number: share of the load, %'),
    (COUNT, 3, ''), (COUNT, -2, ''), (COUNT, 4, '-2 to 3'), (COUNT, -3, '-2 to 3'),
    (COUNT, 'x', 'a number'),
    (ParameterDescriptor(type=Parameter.Type.STRING.value), 'force', ''),
    (ParameterDescriptor(type=Parameter.Type.BOOL.value), True, ''),
    (ParameterDescriptor(type=Parameter.Type.DOUBLE.value), 1e9, '')])
def test_what_a_value_must_be_is_told_with_its_meaning(known, value, expected):
    """By the descriptor of its node; words and what has no range are for the node."""
    assert needed_of(value, known) == expected


@pytest.mark.parametrize(('name', 'expected'), [
    ('plant.drive.bore_mm', True), ('plant.drive.bore', False), ('plant.drive', False),
    ('reu.force.kp', False), ('reu.position.stiffness', False), ('plant.spool.stuck', False),
    ('reu.force.rate_hz', True), ('', False)])
def test_a_key_of_the_run_file_alone_is_told_apart_from_what_may_change(name, expected):
    """
    A gain changes where its block is on; where it is off it is unknown.

    A node without gains, as the coordinator, has no keys of actuators.
    """
    assert _is_key(name, ['use_sim_time', 'reu.force.kp']) is expected
    assert not _is_key(name, ['use_sim_time', 'config_file'])
