"""The line of a group of actuators that stop together, as a value that changes."""

from isa_ros.core.changeable import Changeable, changeables
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import fault, Parameters

EMERGENCY_STOP = 'emergency_stop'
"""Begins the names of the lines of groups; a supply does not have this name."""
OPEN = 'opened'
"""Name of the only value of a line."""


@frozen(kw_only=True)
class _EmergencyLine(Parameters):
    """The line of a group of actuators that stop together."""

    opened: float = fault(
        '1: the line of the emergency stop is open', '1', is_whole=True, ge=0.0, le=1.0)


def line_of(group: str) -> str:
    """Return what the names of a group's values begin with."""
    return f'{EMERGENCY_STOP}.{group}'


def changing_line(group: str) -> dict[str, Changeable]:
    """Return the value of the line of a group as one that may change, by its name."""
    return changeables(_EmergencyLine(), f'{line_of(group)}.')
