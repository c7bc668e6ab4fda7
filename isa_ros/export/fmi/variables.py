"""
The variables of a unit: name, type, unit and range, and the place of the value in the library.

Their order is that of their value references. Names are those of `isa params` and of the signals;
a unit of FMI has no other description of them than this table.
"""

from collections.abc import Mapping, Sequence
from enum import Enum, IntEnum
from typing import NamedTuple

from isa_ros.core.device import EVENTS, MODES, STATES


class Type(IntEnum):
    """Type of a value; an enumeration is one of `ENUMERATIONS`, a number from 0 on."""

    REAL = 0
    INTEGER = 1
    BOOLEAN = 2
    ENUMERATION = 3
    TEXT = 4


class Home(IntEnum):
    """Where the library has a value; `Variable.place` counts from its begin."""

    TIME = 0
    INPUT = 1
    """Of the inputs and of the parameters that may be set before the start."""
    SAMPLE = 2
    """`SAMPLE` of the actuator."""
    REPLY = 3
    """`LOAD_REPLY`."""
    SUPPLY = 4
    """`SUPPLY_SAMPLE`."""
    NUMBER = 5
    """Of the constants."""
    TEXT = 6
    """Of the texts that are constants."""


class Role(Enum):
    """What a variable is for: causality and variability of both versions of FMI follow from it."""

    TIME = 'time'
    INPUT = 'input'
    OUTPUT = 'output'
    START = 'start'
    """A parameter that may be set until the start."""
    CONSTANT = 'constant'
    """A parameter that was resolved when the unit was made."""


ENUMERATIONS: Mapping[str, Sequence[str]] = {
    'Mode': MODES, 'DeviceState': STATES, 'DeviceEvent': EVENTS}
"""Names of the items by type, in the order of their numbers."""


class Variable(NamedTuple):
    """One variable; its value reference is its place in the table."""

    name: str
    kind: Type
    role: Role
    home: Home
    place: int
    meaning: str
    unit: str = '1'
    start: float | str | None = None
    """None of what the unit computes: time and outputs."""
    low: float | None = None
    high: float | None = None
    """The range of what may be set, None: any."""
    enumeration: str = ''
    """Key of `ENUMERATIONS`."""

    @property
    def is_settable(self) -> bool:
        """Return whether its value may be given from outside."""
        return self.role in (Role.INPUT, Role.START)
