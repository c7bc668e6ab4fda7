"""
diagnostic_msgs/DiagnosticStatus: state, mode and reason of an actuator's device, in plain words.

It is published on ``~/device`` on change and once a second of simulated time.
"""

from collections.abc import Mapping

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from isa_ros.core.conditions import BITS, conditions
from isa_ros.core.device import (
    event_name, EVENTS, FAULT, FAULT_REACTION, mode_name, MODES, QUICK_STOP, state_name, STATES)
from msg_adapters.cdr import encode
from msg_adapters.cdr_reader import decode
from msg_adapters.diagnostics import DIGITS, Status
import numpy as np

TYPE = 'diagnostic_msgs/msg/DiagnosticStatus'
TASK = 'device'

REASONS: Mapping[str, str] = {
    'start': 'the run has started', 'ready': 'initialised', 'trip': 'a condition has tripped',
    'clear fault': 'the fault was cleared', 'mode': 'the mode was changed',
    'enable': 'enabled by command', 'disable': 'disabled by command',
    'quick stop': 'quick stop by command', 'stop ends': 'the quick stop has ended',
    'reaction ends': 'the reaction has ended', 'emergency stop': 'emergency stop'}
"""Plain words for the event that led to a state."""

_NUMBERS = {
    'trip_time': 'last_fault_s', 'trip_value': 'last_fault_value',
    'trip_level': 'last_fault_level', 'warning_time': 'last_warning_s', 'age': 'age_s',
    **{field: field for field in (
        'unused_setpoints', 'refused_requests', 'frames_lost_down', 'frames_lost_up',
        'commands_dropped')}}
"""The keys of numbers that are only told where there is something, by field of a `SAMPLE`."""
_REMEDY = 'disabled until ~/clear_fault, which needs its cause to be gone'


def words_of(bits: float) -> str:
    """Return the names of the conditions of a bit set in words; '' for none."""
    return ', '.join(name.replace('_', ' ') for name in conditions(bits))


def bits_of(words: str) -> float:
    """
    Return the bit set of conditions in words; inverse of `words_of`.

    Raises
    ------
    ValueError
        A condition is not one of this version.

    """
    bits = 0
    for name in words.split(', ') if words else ():
        condition = name.replace(' ', '_')
        if condition not in BITS:
            raise ValueError(f'condition {name!r} is unknown')
        bits |= 1 << BITS[condition]
    return float(bits)


def status(name: str, sample: Mapping[str, float]) -> DiagnosticStatus:
    """
    Return the status of actuator ``name``.

    ``sample`` has the fields ``device_state``, ``device_mode``, ``device_event``, ``warnings``,
    ``trips`` and ``state_since`` of a `SAMPLE`.
    """
    number = int(sample['device_state'])
    state, mode = state_name(number), mode_name(sample['device_mode'])
    tripped, warned = words_of(sample['trips']), words_of(sample['warnings'])
    reason = reason_of(sample)
    level, message = DiagnosticStatus.OK, f'{state}, mode {mode}: {reason}'
    if number in (QUICK_STOP, FAULT_REACTION) or warned or tripped:
        level = DiagnosticStatus.WARN
    if number == FAULT:
        level, message = DiagnosticStatus.ERROR, f'{state}: {reason}; {_REMEDY}'
    if tripped and number not in (FAULT_REACTION, FAULT):
        message += f'; reacts to {tripped}'
    if warned:
        message += f'; warning: {warned}'
    values = {
        'state': state, 'mode': mode, 'reason': reason, 'warnings': warned, 'faults': tripped,
        'since_s': f'{sample["state_since"]:.6f}'}
    values |= _more(sample)
    return DiagnosticStatus(
        level=level, name=name, message=message, hardware_id=name,
        values=[KeyValue(key=key, value=value) for key, value in values.items()])


def reason_of(sample: Mapping[str, float] | np.void) -> str:
    """Return in plain words what led to the state of a `SAMPLE`: an event, or what tripped."""
    tripped = words_of(sample['trips'])
    if tripped and int(sample['device_state']) in (FAULT_REACTION, FAULT):
        return tripped
    return REASONS[event_name(sample['device_event'])]


def _more(sample: Mapping[str, float]) -> dict[str, str]:
    """Return what is only told where there is something: trips, counts, and the link."""
    found = {}
    if sample.get('last_trip', 0.0):
        found = {'first_fault': words_of(sample['first_trip']),
                 'last_fault': words_of(sample['last_trip']),
                 'last_fault_s': f'{sample["trip_time"]:.6f}',
                 'last_fault_value': f'{sample["trip_value"]:.{DIGITS}g}',
                 'last_fault_level': f'{sample["trip_level"]:.{DIGITS}g}'}
    if sample.get('warning_time', 0.0):
        found['last_warning_s'] = f'{sample["warning_time"]:.6f}'
    for field in ('unused_setpoints', 'refused_requests'):
        if sample.get(field, 0.0):
            found[field] = f'{sample[field]:.0f}'
    if sample.get('age', 0.0):
        found['age_s'] = f'{sample["age"]:.6f}'
        found['is_stale'] = str(bool(sample['is_stale'])).lower()
        found |= {field: f'{sample[field]:.0f}' for field in (
            'frames_lost_down', 'frames_lost_up', 'commands_dropped')}
    return found


def pack(name: str, sample: Mapping[str, float]) -> bytes:
    """Return the CDR bytes of `status`."""
    return encode(status(name, sample))


def values(data: bytes) -> dict[str, str]:
    """
    Return the values of a status by key; inverse of `pack`.

    Raises
    ------
    CdrError
        The bytes are not a DiagnosticStatus.

    """
    return {pair.key: pair.value for pair in decode(data, DiagnosticStatus).values}


def sample_fields(values_: Mapping[str, str]) -> dict[str, float]:
    """
    Return the fields of a `SAMPLE` that a status has, from its `values`.

    Raises
    ------
    KeyError, ValueError
        A value is missing, or is not one of a device of this version.

    """
    reason = values_['reason']
    events = [event for event, words in REASONS.items() if words == reason]
    found = {
        'device_state': float(STATES.index(values_['state'])),
        'device_mode': float(MODES.index(values_['mode'])),
        'device_event': float(EVENTS.index(events[0] if events else 'trip')),
        'warnings': bits_of(values_['warnings']), 'trips': bits_of(values_['faults']),
        'state_since': float(values_['since_s']),
        'first_trip': bits_of(values_.get('first_fault', '')),
        'last_trip': bits_of(values_.get('last_fault', ''))}
    for field, key in _NUMBERS.items():
        found[field] = float(values_.get(key, 0.0))
    found['is_stale'] = float(values_.get('is_stale') == 'true')
    return found


def joined(name: str, sample: Mapping[str, float]) -> Status:
    """Return `status` as one of `/diagnostics`."""
    own = status(name, sample)
    return Status(name, TASK, own.message, {pair.key: pair.value for pair in own.values},
                  own.level)
