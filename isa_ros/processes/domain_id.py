"""The ROS domain of this process, from its environment."""

from collections.abc import Mapping
import os

from isa_ros.errors import ConfigError

DOMAIN_VARIABLE = 'ROS_DOMAIN_ID'
_LARGEST = 232  # DDS has no port numbers for larger ones


def domain_id(environment: Mapping[str, str] = os.environ) -> int:
    """
    Return the domain; not set or empty: 0.

    Raises
    ------
    ConfigError
        ROS_DOMAIN_ID is not a domain.

    """
    text = environment.get(DOMAIN_VARIABLE) or '0'
    if not text.isdecimal() or int(text) > _LARGEST:
        raise ConfigError(f'{DOMAIN_VARIABLE} = {text!r}, must be an integer from 0 to {_LARGEST}')
    return int(text)
