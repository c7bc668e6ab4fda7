"""The variables with which ROS limits discovery: their values, and the one that forbids it."""

from collections.abc import Mapping
import os

from isa_ros.errors import ConfigError
from isa_ros.processes.domain_id import domain_id

_RANGE = 'ROS_AUTOMATIC_DISCOVERY_RANGE'
_RANGES = ('LOCALHOST', 'SUBNET', 'OFF', 'SYSTEM_DEFAULT')
_LOCALHOST_ONLY = 'ROS_LOCALHOST_ONLY'  # deprecated, but where it is 1 the range is ignored


def refuse_invalid(environment: Mapping[str, str] = os.environ) -> None:
    """
    Refuse values that ROS would replace by another one, and a domain that DDS does not have.

    Empty ones are as if not set.

    Raises
    ------
    ConfigError
        The message has the valid values.

    """
    domain_id(environment)
    for name, values in ((_RANGE, _RANGES), (_LOCALHOST_ONLY, ('0', '1'))):
        value = environment.get(name, '')
        if value and value not in values:
            raise ConfigError(f'{name} = {value!r}, must be one of {", ".join(values)}')


def is_off(environment: Mapping[str, str] = os.environ) -> bool:
    """Return whether no process discovers another, not even on the same host."""
    return environment.get(_RANGE) == 'OFF' and environment.get(_LOCALHOST_ONLY) != '1'


def refuse_off(who: str, otherwise: str = '', environment: Mapping[str, str] = os.environ) -> None:
    """
    Refuse to run a node that other processes have to discover.

    ``who``: the nodes; ``otherwise``: another way to run.

    Raises
    ------
    ConfigError
        Discovery is off.

    """
    if is_off(environment):
        raise ConfigError(
            f'{_RANGE} = OFF: no process discovers another, so that {who} cannot take part; set '
            f'it to LOCALHOST{otherwise}')
