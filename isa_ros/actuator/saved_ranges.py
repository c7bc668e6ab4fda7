"""
Ranges of the whole numbers in the saved state of an actuator.

Kernels use them as places in tables and as bits: one beyond its range would read memory that is
not theirs. Steps and counts may be any; floats are checked to be finite.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from isa_ros.core.conditions import CONDITIONS, REACTIONS
from isa_ros.core.device import EVENTS, MODES, STATES
from isa_ros.core.signals import EVERY_KIND, Records, WAS_REFUSED
from isa_ros.errors import ConfigError
from isa_ros.reu.bumpless import EVERY_BLOCK
from isa_ros.reu.protection import EXTENDING, GONE, RETRACTING

_FLAG, _BITS, _MODE = 1, (1 << len(CONDITIONS)) - 1, len(MODES) - 1
_DIRECTIONS = EXTENDING | RETRACTING

LARGEST: Mapping[str, int] = {
    'status.state': len(STATES) - 1, 'status.event': len(EVENTS) - 1,
    'status.mode': _MODE, 'status.acting': _MODE, 'status.requested_mode': _MODE,
    'status.is_on': _FLAG, 'status.is_stopping': _FLAG, 'status.auto_enable': _FLAG,
    'status.is_energised': _FLAG, 'status.is_open': _FLAG,
    'status.is_damping': _FLAG, 'status.is_returning': _FLAG, 'status.flow.is_held': _FLAG,
    'status.requested_enable': _FLAG,
    'status.fade.begins': EVERY_BLOCK, 'status.fade.is_on': _FLAG,
    'status.requests': EVERY_KIND, 'status.refused': EVERY_KIND,
    'status.trips': _BITS, 'status.warnings': _BITS,
    'protection.trips': _BITS, 'protection.warnings': _BITS, 'protection.first': _BITS,
    'protection.last': len(CONDITIONS), 'protection.last_warning': len(CONDITIONS),
    'protection.present': _BITS, 'protection.busy': _BITS, 'protection.kept': _BITS,
    'protection.clears': _FLAG, 'protection.supply_taken': GONE,
    'protection.reaction': len(REACTIONS) - 1, 'protection.inhibited': _DIRECTIONS,
    'link_lost': _FLAG,
    'kinds': EVERY_KIND | WAS_REFUSED, 'is_enabled': _FLAG, 'mode': _MODE}
"""Largest number by field of a `REU_STATE` or of a `COMMAND`; the smallest is 0."""


def refuse_beyond(name: str, found: Iterable[tuple[str, Records]]) -> None:
    """
    Refuse a saved state with a whole number beyond its range.

    ``found`` are its rows by name, ``name`` is that of the actuator.

    Raises
    ------
    ConfigError
        Names the number, its value and its range.

    """
    for part, rows in found:
        for field, values in _fields(rows):
            largest = LARGEST.get(field)
            if largest is not None and not ((values >= 0) & (values <= largest)).all():
                beyond = values[(values < 0) | (values > largest)].flat[0]
                raise ConfigError(
                    f'{name}.{part}: saved state has {field} = {beyond}, must be 0 to {largest}')


def _fields(rows: Any, prefix: str = '') -> Iterator[tuple[str, Any]]:
    """Yield the fields of rows that are no records, with dotted names."""
    for field in rows.dtype.names or ():
        below, dotted = rows[field], f'{prefix}{field}'
        if below.dtype.names is None:
            yield dotted, below
        else:
            yield from _fields(below, f'{dotted}.')
