"""
The conditions that the REU watches, as data: a bit each, in words and with the unit.

A bit set is a whole number, so that it fits into a record of floats. A condition is *above* its
levels or *below* them; levels are those of its parameter set in `reu/protection_sheet.py`, and
`reu/protection.py` measures and judges it.
"""

from collections.abc import Mapping
from typing import NamedTuple

from isa_ros.core.units import of_coordinate


class Condition(NamedTuple):
    """One condition that may cause a warning or a trip."""

    name: str
    """Its key below ``reu.protection``."""
    quantity: str
    """What is compared with the levels, in words."""
    unit: str
    """SI unit of the quantity: of a linear actuator | of a rotary one."""
    rating: str
    """What its levels are parts of; '' for levels in the unit of the quantity."""
    is_above: bool = True
    """Whether it is met above its levels; else below them."""


CONDITIONS = (
    Condition('setpoint_timeout', 'time since the last setpoint', 's', ''),
    Condition('end_of_stroke', 'distance to the nearer end of the stroke', 'm | rad',
              'the stroke', is_above=False),
    Condition('overspeed', 'estimated speed', 'm/s | rad/s',
              'the speed at full opening with the relief pressure over one land'),
    Condition('overload', 'measured force', 'N | Nm', 'the range of the force sensor'),
    Condition('overpressure', 'higher chamber pressure', 'Pa', 'the range of the sensors'),
    Condition('overcurrent', 'measured current', 'A', 'the range of the sensor'),
    Condition('overtemperature', 'temperature', 'celsius', ''),
    Condition('supply_low', 'supply pressure', 'Pa', 'the opening pressure of the relief valves',
              is_above=False),
    Condition('relief_open', 'higher chamber pressure', 'Pa',
              'the opening pressure of the relief valves'),
    Condition('load_cell_implausible', 'force that the pressures do not explain', 'N | Nm',
              'the range of the force sensor'),
    Condition('encoder_jump', 'speed between two conversions', 'm/s | rad/s',
              'the speed at full opening with the relief pressure over one land'),
    Condition('link_lost', 'time since the last frame of the link', 's', ''),
    Condition('spool_deviation', 'distance of the spool from where its reference puts it', 'm',
              'the stop of the spool'),
)
"""All conditions; the place of each is its bit."""

BITS: Mapping[str, int] = {condition.name: k for k, condition in enumerate(CONDITIONS)}
"""Bit of each condition by name."""

REACTIONS = ('none', 'warn', 'limit', 'hold', 'damp', 'quick_stop', 'disable')
"""What a trip may cause, from the weakest to the strongest."""

_SHOWN = {'Pa': ('MPa', 1e6), 'A': ('mA', 1e-3), 'm': ('mm', 1e-3), 's': ('ms', 1e-3)}
"""Unit and its size in SI, for units whose usual values are not readable in SI."""


def conditions(value: float) -> list[str]:
    """
    Return the names of a bit set of `SAMPLE`: ``warnings`` or ``trips``.

    Raises
    ------
    ValueError
        The value is no set of these conditions.

    """
    if not 0 <= value < 1 << len(CONDITIONS) or value != int(value):
        raise ValueError(
            f'{value!r} is not a set of conditions, must be a whole number >= 0 and < '
            f'{1 << len(CONDITIONS)}')
    return [name for name, bit in BITS.items() if int(value) >> bit & 1]


def shown(value: float, unit: str) -> str:
    """Return a value in SI with a readable unit: ``23.1 MPa``."""
    name, size = _SHOWN.get(unit, (unit, 1.0))
    return f'{value / size:.4g} {name}'


def words(
        name: str, value: float | None, level: float, delay: float = 0.0, *,
        is_trip: bool = False, is_rotary: bool = False) -> str:
    """
    Return one line about a condition: what, measured value, level and unit.

    ``value`` (None: unknown) and ``level`` are SI, ``delay`` (s) is the time beyond the level.
    """
    condition = CONDITIONS[BITS[name]]
    unit = of_coordinate(condition.unit, is_rotary)
    measured = '' if value is None else f' {shown(value, unit)},'
    side = 'above' if condition.is_above else 'below'
    duration = f' for {shown(delay, "s")}' if delay > 0.0 else ''
    return (f'{condition.quantity}{measured} {side} its {"trip" if is_trip else "warning"} level '
            f'{shown(level, unit)}{duration}')
