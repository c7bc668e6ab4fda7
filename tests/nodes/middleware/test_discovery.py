"""Variables of the discovery: invalid values, and a run whose processes cannot meet."""

from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware.discovery import is_off
from isa_ros.nodes.middleware.environment import set_defaults
import pytest

RANGE, LOCALHOST_ONLY = 'ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_LOCALHOST_ONLY'


@pytest.mark.parametrize(('name', 'value', 'message'), [
    (RANGE, 'LOCAL', "ROS_AUTOMATIC_DISCOVERY_RANGE = 'LOCAL', must be one of LOCALHOST, SUBNET"),
    (RANGE, 'off', "ROS_AUTOMATIC_DISCOVERY_RANGE = 'off', must be one of"),
    ('ROS_DOMAIN_ID', '300', "ROS_DOMAIN_ID = '300', must be an integer from 0 to 232"),
    (LOCALHOST_ONLY, 'true', "ROS_LOCALHOST_ONLY = 'true', must be one of 0, 1"),
])
def test_a_value_that_ros_would_replace_is_refused(name, value, message):
    with pytest.raises(ConfigError, match=f'^{message}'):
        set_defaults({name: value})


@pytest.mark.parametrize(('environment', 'off'), [
    ({}, False), ({RANGE: ''}, False), ({RANGE: 'SUBNET'}, False), ({RANGE: 'OFF'}, True),
    ({RANGE: 'OFF', LOCALHOST_ONLY: '0'}, True), ({RANGE: 'OFF', LOCALHOST_ONLY: '1'}, False)])
def test_discovery_is_off_unless_the_older_variable_wins(environment, off):
    """In rcl: it ignores the range where ROS_LOCALHOST_ONLY is 1."""
    assert is_off(environment) is off
