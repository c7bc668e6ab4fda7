"""
The mapping file: which column or topic and field of a measurement is which quantity.

    actuator: ram                   # of the configuration; default: the only one
    time: {column: t, unit: ms}     # of a CSV file, or {rate_hz: 1000}; bags have their own
    skip_lines: 6                   # of a CSV file, before the line with the names
    clock_ppm: 40.0                 # by which the clock of the measurement is fast
    signals:
      position_command: {column: setpoint, unit: mm}
      velocity_command: {from: position_command}      # its slope
      position: {topic: /press/state, field: 'position[0]', unit: mm, sign: -1, offset: 150.0}
      pressure_a: {column: 4, unit: bar, scale: 0.061, delay_ms: 2.0}

A value is ``sign * scale * number + offset`` in its unit; with a delay of a sensor, what it shows
happened so much earlier.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from isa_ros.analysis.measured.quantities import QUANTITIES, UNITS
from isa_ros.config.text.yaml_text import read
from isa_ros.core.suggest import alternatives
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError

PLACE, VELOCITY = 'position_command', 'velocity_command'
_FROM = 'from'
SLOPE = f'{{{_FROM}: {PLACE}}}'
"""What says that the commanded velocity is the slope of the commanded position."""
_ROTARY_UNITS = ('rad', 'deg', 'rad/s', 'Nm')
_TOP = ('actuator', 'time', 'skip_lines', 'clock_ppm', 'signals')
_LARGEST_PPM = 1e5    # an oscillator is within 100 ppm, the clock of a script within some %
_TIME = ('column', 'unit', 'rate_hz')
_SIGNAL = ('column', 'topic', 'field', 'unit', 'sign', 'scale', 'offset', 'delay_ms')


class SignalSource(NamedTuple):
    """Where a signal's numbers are: a column by name or number from 1, or a topic and a field."""

    column: str | int | None
    topic: str
    field: str


class MappedSignal(NamedTuple):
    """One signal; ``factor`` is sign times scale, ``offset`` in ``unit``, ``delay`` in s."""

    source: SignalSource
    unit: str
    factor: float
    offset: float
    delay: float
    where: str
    """Place in the mapping file, for messages."""


class MeasurementMapping(NamedTuple):
    """A mapping file."""

    name: str
    actuator: str | None
    time: str | int | None
    """Column of the time; None: the rate holds."""
    time_scale: float
    """s in one of its unit."""
    rate: float | None
    """Samples per second."""
    skip_lines: int
    clock: float
    """Relative error of the clock: 4e-5 for one that is 40 ppm fast."""
    signals: Mapping[str, MappedSignal]
    """By quantity."""
    has_slope: bool = False
    """Whether the commanded velocity is the slope of the commanded position."""

    @property
    def is_rotary(self) -> bool:
        """Return whether its units are those of a rotary actuator."""
        return any(own.unit in _ROTARY_UNITS for own in self.signals.values())


def load_mapping(path: Path) -> MeasurementMapping:
    """
    Return the mapping of a file.

    Raises
    ------
    ConfigError
        It cannot be read, or a key, quantity or value is refused; with the place.

    """
    tree, name = read(path), path.name
    _refuse_others(tree, _TOP, name)
    time = _section(tree, 'time', name)
    _refuse_others(time, _TIME, f'{name}: time')
    if 'column' in time and 'rate_hz' in time:
        raise ConfigError(f'{name}: time has column and rate_hz, must have only one of them')
    unit = time.get('unit', 's')
    if not isinstance(unit, str) or unit != 's' and getattr(UNITS.get(unit), 'si', '') != 's':
        raise ConfigError(f'{name}: time.unit = {unit!r}, must be one of s, ms, us')
    rate = _number(time, 'rate_hz', f'{name}: time', 0.0)
    if 'rate_hz' in time and rate <= 0.0:
        raise ConfigError(f'{name}: time.rate_hz = {rate:g}, must be > 0')
    skipped = tree.get('skip_lines', 0)
    if not isinstance(skipped, int) or isinstance(skipped, bool) or skipped < 0:
        raise ConfigError(f'{name}: skip_lines = {skipped!r}, must be a whole number >= 0')
    signals = _section(tree, 'signals', name)
    if not signals:
        raise ConfigError(f'{name}: lacks signals, by quantity: {", ".join(QUANTITIES)}')
    has_slope = _has_slope(signals, f'{name}: signals')
    clock_ppm = _number(tree, 'clock_ppm', name, 0.0)
    if abs(clock_ppm) > _LARGEST_PPM:
        raise ConfigError(f'{name}: clock_ppm = {clock_ppm:g}, must be -{_LARGEST_PPM:g} to '
                          f'{_LARGEST_PPM:g}')
    actuator = tree.get('actuator')
    return MeasurementMapping(
        name, None if actuator is None else str(actuator),
        _column(time, f'{name}: time'),
        UNITS[unit].scale if unit != 's' else 1.0, rate or None, skipped,
        clock_ppm * 1e-6,
        {quantity: _signal(signals, quantity, f'{name}: signals') for quantity in signals
         if not (has_slope and quantity == VELOCITY)}, has_slope)


def _has_slope(signals: Mapping[str, Any], where: str) -> bool:
    """Return whether the commanded velocity is to be made from the commanded position."""
    own = signals.get(VELOCITY)
    if not isinstance(own, dict) or _FROM not in own:
        return False
    if own != {_FROM: PLACE}:
        raise ConfigError(f'{where}.{VELOCITY}: must be {SLOPE} without other keys, or a signal')
    if PLACE not in signals:
        raise ConfigError(f'{where}.{VELOCITY}: {_FROM} = {PLACE}, which is not mapped')
    return True


def _signal(signals: Mapping[str, Any], quantity: str, where: str) -> MappedSignal:
    if quantity not in QUANTITIES:
        raise ConfigError(
            f'{where}.{quantity} is unknown; {alternatives(quantity, QUANTITIES)}')
    own = _section(signals, quantity, where)
    where = f'{where}.{quantity}'
    _refuse_others(own, _SIGNAL, where)
    if ('column' in own) == ('topic' in own):
        raise ConfigError(f'{where}: must have either column, or topic and field')
    if 'topic' in own and 'field' not in own:
        raise ConfigError(f'{where}: lacks field, such as position[0]')
    if 'unit' not in own:
        raise ConfigError(f'{where}: lacks unit')
    sign = own.get('sign', 1)
    if isinstance(sign, bool) or sign not in (1, -1):
        raise ConfigError(f'{where}.sign = {sign!r}, must be 1 or -1')
    scale = _number(own, 'scale', where, 1.0)
    if scale == 0.0:
        raise ConfigError(f'{where}: scale = 0, must not be 0')
    return MappedSignal(
        SignalSource(_column(own, where), str(own.get('topic', '')), str(own.get('field', ''))),
        str(own['unit']), sign * scale,
        _number(own, 'offset', where, 0.0), _number(own, 'delay_ms', where, 0.0) * MILLI, where)


def _column(tree: Mapping[str, Any], where: str) -> str | int | None:
    """Return the name or number of a column, None if there is none."""
    if 'column' not in tree:
        return None
    column: str | int = tree['column']
    if isinstance(column, bool) or not isinstance(column, (str, int)):
        raise ConfigError(
            f'{where}.column = {column!r}, must be a name, or a whole number from 1')
    return column


def _section(tree: Mapping[str, Any], key: str, where: str) -> Mapping[str, Any]:
    found = tree.get(key, {})
    if not isinstance(found, dict):
        raise ConfigError(f'{where}: {key} = {found!r}, must be a section of `key: value`')
    return found


def _refuse_others(tree: Mapping[str, Any], keys: tuple[str, ...], where: str) -> None:
    for key in tree:
        if key not in keys:
            raise ConfigError(f'{where}: {key} is unknown; {alternatives(str(key), keys)}')


def _number(tree: Mapping[str, Any], key: str, where: str, default: float) -> float:
    value = tree.get(key, default)
    if not isinstance(value, (int, float)) or isinstance(value, bool) or (
            not abs(value) < float('inf')):
        raise ConfigError(f'{where}: {key} = {value!r}, must be a number')
    return float(value)
