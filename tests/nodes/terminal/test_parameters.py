"""Values of parameters as they are typed."""

from isa_ros.nodes.terminal.parameters import _parameter, ParameterChange
import pytest


@pytest.mark.parametrize(('text', 'expected'), [
    ('2e-5', 2e-5), ('3e+4', 3e4), ('7', 7), ('0.5', 0.5), ('true', True), ('force', 'force'),
    ('[1.5, 2.5]', [1.5, 2.5])])
def test_a_number_without_a_point_is_a_number(text, expected):
    """YAML reads 2e-5 as a text."""
    found = _parameter(ParameterChange('reu.force.kp', text)).value
    assert found == expected and isinstance(found, type(expected))
