"""
The variables of a unit: name, type, unit and range, and the place of the value in the library.

Their order is that of their value references. Names are those of `isa params` and of the signals;
a unit of FMI has no other description of them than this table.
"""

from collections.abc import Mapping, Sequence
from enum import Enum
from typing import NamedTuple

from isa_ros.core.device import EVENTS, MODES, STATES


class Type(Enum):
    """Type of a value, as types.h of the library names it."""

    REAL = 'number'
    INTEGER = 'whole number'
    BOOLEAN = 'yes or no'
    ENUMERATION = 'one of `ENUMERATIONS`, by its number from 0 on'
    TEXT = 'text'


class Home(Enum):
    """Where the library has a value, likewise; `Variable.place` counts from its begin."""

    TIME = 'time'
    INPUT = 'inputs, and parameters that may be set'
    SAMPLE = '`SAMPLE` of the actuator'
    REPLY = '`LOAD_REPLY`'
    SUPPLY = '`SUPPLY_SAMPLE`'
    NUMBER = 'constants'
    TEXT = 'constants that are texts'


class UnitRole(Enum):
    """What a variable is for: causality and variability of both versions of FMI follow from it."""

    TIME = 'time'
    INPUT = 'input'
    OUTPUT = 'output'
    START = 'start'
    """A parameter that may be set until the start."""
    TUNED = 'tuned'
    """A parameter that may be set at any time; it takes effect with the next step."""
    CONSTANT = 'constant'
    """A parameter that was resolved when the unit was made."""


ENUMERATIONS: Mapping[str, Sequence[str]] = {
    'Mode': MODES, 'DeviceState': STATES, 'DeviceEvent': EVENTS}
"""Names of the items by type, in the order of their numbers."""


class Variable(NamedTuple):
    """One variable; its value reference is its place in the table."""

    name: str
    kind: Type
    role: UnitRole
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
