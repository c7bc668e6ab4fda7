"""
diagnostic_msgs/DiagnosticStatus: state, mode and reason of an actuator's device, in plain words.

It is published on ``~/device`` on change and once a second of simulated time.
"""

from collections.abc import Mapping

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from isa_ros.core.conditions import conditions
from isa_ros.core.device import (
    event_name, FAULT, FAULT_REACTION, mode_name, QUICK_STOP, state_name)
from msg_adapters.cdr import encode
from msg_adapters.cdr_reader import decode
from msg_adapters.diagnostics import Status

TYPE = 'diagnostic_msgs/msg/DiagnosticStatus'
TASK = 'device'

REASONS: Mapping[str, str] = {
    'start': 'the run has started', 'ready': 'initialised', 'trip': 'a condition has tripped',
    'clear fault': 'the fault was cleared', 'mode': 'the mode was changed',
    'enable': 'enabled by command', 'disable': 'disabled by command',
    'quick stop': 'quick stop by command', 'stop ends': 'the quick stop has ended',
    'reaction ends': 'the reaction has ended'}
"""Plain words for the event that led to a state."""

_REMEDY = 'disabled until ~/clear_fault, which needs its cause to be gone'


def words_of(bits: float) -> str:
    """Return the names of the conditions of a bit set in words; '' for none."""
    return ', '.join(name.replace('_', ' ') for name in conditions(bits))


def status(name: str, sample: Mapping[str, float]) -> DiagnosticStatus:
    """
    Return the status of actuator ``name``.

    ``sample`` has the fields ``device_state``, ``device_mode``, ``device_event``, ``warnings``,
    ``trips`` and ``state_since`` of a `SAMPLE`.
    """
    number = int(sample['device_state'])
    state, mode = state_name(number), mode_name(sample['device_mode'])
    tripped, warned = words_of(sample['trips']), words_of(sample['warnings'])
    is_fault = number in (FAULT_REACTION, FAULT)
    reason = tripped if tripped and is_fault else REASONS[event_name(sample['device_event'])]
    level, message = DiagnosticStatus.OK, f'{state}, mode {mode}: {reason}'
    if number in (QUICK_STOP, FAULT_REACTION) or warned or tripped:
        level = DiagnosticStatus.WARN
    if number == FAULT:
        level, message = DiagnosticStatus.ERROR, f'{state}: {reason}; {_REMEDY}'
    if tripped and not is_fault:
        message += f'; reacts to {tripped}'
    if warned:
        message += f'; warning: {warned}'
    values = {
        'state': state, 'mode': mode, 'reason': reason, 'warnings': warned, 'faults': tripped,
        'since_s': f'{sample["state_since"]:.6f}'}
    return DiagnosticStatus(
        level=level, name=name, message=message, hardware_id=name,
        values=[KeyValue(key=key, value=value) for key, value in values.items()])


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


def joined(name: str, sample: Mapping[str, float]) -> Status:
    """Return `status` as one of `/diagnostics`."""
    own = status(name, sample)
    return Status(name, TASK, own.message, {pair.key: pair.value for pair in own.values},
                  own.level)
