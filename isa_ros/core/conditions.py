"""
The conditions that the REU watches, as data: a row each, from which all else is made.

A bit set is a whole number, so that it fits into a record of floats. A condition is *above* its
levels or *below* them. From its row come its parameters (`isa_ros.reu.protection_sheet`), its bit,
its error on a bus (`isa_ros.fieldbus.device.faults`) and its lines in the pages; a line
of `measure` in `isa_ros.reu.protection` is its quantity.
"""

from collections.abc import Mapping
from typing import NamedTuple

REACTIONS = ('none', 'warn', 'limit', 'hold', 'damp', 'quick_stop', 'disable', 'block')
"""What a trip may cause, from the weakest to the strongest."""
FAULTS = ('quick_stop', 'disable', 'block')
"""Those that end in the state fault, until it is cleared."""

ASSUMED = 'assumed'
RATINGS: Mapping[str, str] = {
    'stroke': 'the stroke',
    'speed': 'the speed at full opening with the relief pressure over one land',
    'force_range': 'the range of the force sensor',
    'pressure_range': 'the range of the sensors',
    'current_range': 'the range of the sensor',
    'opening_pressure': 'the opening pressure of the relief valves',
    'spool_stop': 'the stop of the spool'}
"""What levels may be parts of, by its name in `isa_ros.reu.protection.Ratings`."""

CURRENT, VOLTAGE, TEMPERATURE = 1 << 1, 1 << 2, 1 << 3
COMMUNICATION, PROFILE, MANUFACTURER = 1 << 4, 1 << 5, 1 << 7
"""Bits of the error register 0x1001 besides that of any error."""


class ErrorCode(NamedTuple):
    """What one error is reported as on a bus."""

    code: int
    """Of CiA 301 and 402; 0xFF00 and above: of the manufacturer."""
    register: int
    """Bit of 0x1001 besides that of any error."""
    words: str
    """Meaning of the code in the profile."""


class LevelDefaults(NamedTuple):
    """What the parameters of a condition are by default, and what they may be."""

    compared: str
    """What a level is, in words."""
    most: float
    """The highest level."""
    warning: float
    """In the unit of the quantity, or part of the rating; 0: off. So is ``trip``."""
    trip: float
    delay_ms: float
    reaction: str
    may_limit: bool = False
    """Whether the reaction `limit` is possible: a direction of the valve makes it worse."""
    refused: tuple[str, ...] = ()
    """Reactions that are refused."""
    why_refused: str = ''
    warning_source: str = ASSUMED
    trip_source: str = ASSUMED


class Condition(NamedTuple):
    """One condition that may cause a warning or a trip."""

    name: str
    """Its key below ``reu.protection``."""
    meaning: str
    quantity: str
    """What is compared with the levels, in words."""
    unit: str
    """SI unit of the quantity: of a linear actuator | of a rotary one."""
    rating: str
    """One of `RATINGS`, of which the levels are parts; '' for levels in the unit."""
    error: ErrorCode
    levels: LevelDefaults | None = None
    """None: the condition is a timeout, with a key of its own in the sheet or at the link."""
    is_above: bool = True
    """Whether it is met above its levels; else below them."""

    @property
    def rating_words(self) -> str:
        """Return what the levels are parts of; '' for levels in the unit of the quantity."""
        return RATINGS[self.rating] if self.rating else ''

    @property
    def level_unit(self) -> str:
        """Return the unit of the levels in the sheet."""
        return '1' if self.rating else self.unit


_BY_SENSORS = ('hold', 'damp', 'quick_stop')
_STOPPING = (*_BY_SENSORS, 'disable', 'block')

CONDITIONS = (
    Condition(
        'setpoint_timeout', 'An enabled actuator has had no setpoint for too long.',
        'time since the last setpoint', 's', '',
        ErrorCode(0xFF00, MANUFACTURER, 'manufacturer: setpoint timeout')),
    Condition(
        'end_of_stroke', 'The piston or rotor is near an end of its own stroke.',
        'distance to the nearer end of the stroke', 'm | rad', 'stroke',
        ErrorCode(0x8612, PROFILE, 'reference limit'),
        LevelDefaults(
            'distance, part of the stroke', 0.5, warning=0.0, trip=0.0, delay_ms=0.0,
            reaction='limit', may_limit=True, refused=_STOPPING,
            why_refused='an actuator that stops there could not leave it'),
        is_above=False),
    Condition(
        'overspeed', 'The estimated speed is higher than the valve alone can cause.',
        'estimated speed', 'm/s | rad/s', 'speed',
        ErrorCode(0x8400, PROFILE, 'velocity speed controller'),
        LevelDefaults(
            'speed over that of the valve, from its rated flow', 10.0, warning=0.8, trip=1.1,
            delay_ms=10.0, reaction='warn', may_limit=True)),
    Condition(
        'overload', 'The force sensor is near or at its end of range.',
        'measured force', 'N | Nm', 'force_range',
        ErrorCode(0x8311, PROFILE, 'excess torque'),
        LevelDefaults(
            'force over the range of its sensor', 1.0, warning=0.95, trip=0.0,
            delay_ms=5.0, reaction='disable', may_limit=True)),
    Condition(
        'overpressure', 'A chamber is far above the opening pressure of its relief valve.',
        'higher chamber pressure', 'Pa', 'pressure_range',
        ErrorCode(0xFF04, MANUFACTURER, 'manufacturer: overpressure'),
        LevelDefaults(
            'pressure over the range of its sensor', 1.0, warning=0.95, trip=0.99,
            delay_ms=50.0, reaction='disable', may_limit=True)),
    Condition(
        'overcurrent', "The amplifier's current is more than the valve can use.",
        'measured current', 'A', 'current_range',
        ErrorCode(0x2310, CURRENT, 'continuous over current'),
        LevelDefaults(
            'current over the range of its sensor', 1.0, warning=0.9, trip=0.99,
            delay_ms=20.0, reaction='disable')),
    Condition(
        'overtemperature',
        'The actuator is warmer than its operating temperature, 80 celsius by paper Table 2.',
        'temperature', 'celsius', '',
        ErrorCode(0x4310, TEMPERATURE, 'excess temperature drive'),
        LevelDefaults(
            'temperature', 200.0, warning=75.0, trip=80.0, delay_ms=100.0,
            reaction='disable', trip_source='paper Table 2')),
    Condition(
        'supply_low', 'The supply pressure is lower than the loops need.',
        'supply pressure', 'Pa', 'opening_pressure',
        ErrorCode(0x3120, VOLTAGE, 'mains under-voltage: here the oil supply'),
        LevelDefaults(
            'pressure over the opening of the relief valves', 1.0, warning=0.5, trip=0.2,
            delay_ms=10.0, reaction='disable'),
        is_above=False),
    Condition(
        'relief_open', 'A relief valve lets oil through; paper section 2.7: from 22 MPa on.',
        'higher chamber pressure', 'Pa', 'opening_pressure',
        ErrorCode(0xFF08, MANUFACTURER, 'manufacturer: relief valve open'),
        LevelDefaults(
            'pressure over the opening of the relief valves', 2.0, warning=1.0, trip=0.0,
            delay_ms=5.0, reaction='warn', may_limit=True,
            warning_source='paper section 2.7, they open at 22 MPa')),
    Condition(
        'load_cell_implausible',
        'Pressures times areas, less friction and inertia, are not what the force sensor reads.',
        'force that the pressures do not explain', 'N | Nm', 'force_range',
        ErrorCode(0x7300, PROFILE, 'sensor: here the load cell'),
        LevelDefaults(
            'force over the range of its sensor', 1.0, warning=0.05, trip=0.1,
            delay_ms=50.0, reaction='disable', refused=_BY_SENSORS,
            why_refused='they use the force sensor, which may be wrong then')),
    Condition(
        'encoder_jump',
        'The encoder moves further between two conversions than the piston or rotor can.',
        'speed between two conversions', 'm/s | rad/s', 'speed',
        ErrorCode(0x7320, PROFILE, 'position sensor'),
        LevelDefaults(
            'speed over that of the valve, from its rated flow', 1e3, warning=2.0, trip=4.0,
            delay_ms=0.0, reaction='disable', refused=_BY_SENSORS,
            why_refused='they use the encoder, which is wrong then')),
    Condition(
        'link_lost', "No frame of the link has arrived for the time of the link's watchdog.",
        'time since the last frame of the link', 's', '',
        ErrorCode(0x8100, COMMUNICATION, 'communication: the link inside the actuator')),
    Condition(
        'spool_deviation',
        'The spool is not where its reference puts it after the lag of a sound valve.',
        'distance of the spool from where its reference puts it', 'm', 'spool_stop',
        ErrorCode(0xFF0C, MANUFACTURER, 'manufacturer: spool away from its reference'),
        LevelDefaults(
            'distance over the stop of the spool', 2.0, warning=0.05, trip=0.15,
            delay_ms=50.0, reaction='disable')),
    Condition(
        'watchdog', 'The program of the REU has stopped, and its output was switched off.',
        'time without the program', 's', '',
        ErrorCode(0xFF0D, MANUFACTURER, 'manufacturer: watchdog of the REU')),
    Condition(
        'sensor_range',
        'A reading is outside of its range (a broken wire), or both pressures are zero.',
        'distance of a reading from the range of its sensor, part of it', '1', '',
        ErrorCode(0x7310, PROFILE, 'sensor: reading out of its range'),
        LevelDefaults(
            'distance from the range over the range', 1.0, warning=0.0, trip=0.05,
            delay_ms=2.0, reaction='disable')),
    Condition(
        'position_error',
        'The piston or rotor is far from its reference, and does not move there (mode position).',
        'distance from the reference', 'm | rad', 'stroke',
        ErrorCode(0xFF0F, MANUFACTURER, 'manufacturer: position not reached'),
        LevelDefaults(
            'distance over the stroke', 1.0, warning=0.05, trip=0.1, delay_ms=200.0,
            reaction='disable')),
    Condition(
        'force_error', 'The force is far from its reference, which the valve could reach.',
        'distance of the force from its reference', 'N | Nm', 'force_range',
        ErrorCode(0x8331, PROFILE, 'torque fault: the force does not follow'),
        LevelDefaults(
            'force over the range of its sensor', 2.0, warning=0.1, trip=0.2,
            delay_ms=100.0, reaction='disable')),
    Condition(
        'oscillation', 'The force swings, and its reference does not.',
        'mean swing of the force beyond that of its reference', 'N | Nm', 'force_range',
        ErrorCode(0xFF10, MANUFACTURER, 'manufacturer: the force oscillates'),
        LevelDefaults(
            'force over the range of its sensor', 1.0, warning=0.03, trip=0.1,
            delay_ms=100.0, reaction='disable')),
    Condition(
        'runaway', 'The piston or rotor moves against the flow that its valve lets through.',
        'speed against the flow', 'm/s | rad/s', 'speed',
        ErrorCode(0x8402, PROFILE, 'velocity speed controller: runs away'),
        LevelDefaults(
            'speed over that of the valve, from its rated flow', 1.0, warning=0.02, trip=0.05,
            delay_ms=20.0, reaction='disable')),
)
"""All conditions; the place of each is its bit. Bags hold bits: a new one goes to the end."""

BITS: Mapping[str, int] = {condition.name: k for k, condition in enumerate(CONDITIONS)}
"""Bit of each condition by name."""


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
