"""
diagnostic_msgs/DiagnosticStatus: state, mode and reason of an actuator's device, in plain words.

It is published on ``~/device`` on change and once a second of simulated time.
"""

from collections.abc import Mapping, Sequence

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from isa_ros.core.device import (
    CONDITIONS, event_name, FAULT, FAULT_REACTION, mode_name, QUICK_STOP, state_name)

TYPE = 'diagnostic_msgs/msg/DiagnosticStatus'

REASONS: Mapping[str, str] = {
    'start': 'the run has started', 'ready': 'initialised', 'trip': 'a condition has tripped',
    'clear fault': 'the fault was cleared', 'mode': 'the mode was changed',
    'enable': 'enabled by command', 'disable': 'disabled by command',
    'quick stop': 'quick stop by command', 'stop ends': 'the quick stop has ended',
    'reaction ends': 'the reaction has ended'}
"""Plain words for the event that led to a state."""

_REMEDY = 'disabled until ~/clear_fault, which needs its cause to be gone'


def words_of(bits: float, conditions: Sequence[str] = CONDITIONS) -> str:
    """Return the names of the conditions of a bit set; '' for none."""
    names = []
    for bit in range(int(bits).bit_length()):
        if int(bits) >> bit & 1:
            names.append(conditions[bit] if bit < len(conditions) else f'condition {bit}')
    return ', '.join(names)


def status(name: str, sample: Mapping[str, float]) -> DiagnosticStatus:
    """
    Return the status of actuator ``name``.

    ``sample`` has the fields ``device_state``, ``device_mode``, ``device_event``, ``warnings``,
    ``trips`` and ``state_since`` of a `SAMPLE`.
    """
    number = int(sample['device_state'])
    state, mode = state_name(number), mode_name(sample['device_mode'])
    tripped, warned = words_of(sample['trips']), words_of(sample['warnings'])
    reason = tripped or REASONS[event_name(sample['device_event'])]
    level, message = DiagnosticStatus.OK, f'{state}, mode {mode}: {reason}'
    if number in (QUICK_STOP, FAULT_REACTION) or warned:
        level = DiagnosticStatus.WARN
    if number == FAULT:
        level, message = DiagnosticStatus.ERROR, f'{state}: {reason}; {_REMEDY}'
    if warned:
        message += f'; warning: {warned}'
    values = {
        'state': state, 'mode': mode, 'reason': reason, 'warnings': warned, 'faults': tripped,
        'since_s': f'{sample["state_since"]:.6f}'}
    return DiagnosticStatus(
        level=level, name=name, message=message, hardware_id=name,
        values=[KeyValue(key=key, value=value) for key, value in values.items()])
