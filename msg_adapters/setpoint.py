"""
Conversion of setpoints, as commanded, applied and sent: JointState <-> COMMAND row.

``~/applied_setpoint`` is what is in force, ``~/sent_setpoint`` what was handed to the link of an
actuator at a tick: the same entries, where a value that the command does not have is NaN.
"""

from collections.abc import Mapping, Sequence
import math

from isa_ros.core.device import MODES, REFERENCES
from isa_ros.core.signals import (
    COMMAND, EVERY_KIND, GAINS_OF_COMMAND, HAS_ENABLE, HAS_GAINS, HAS_MODE, HAS_REFERENCE,
    HAS_SETPOINT, WAS_REFUSED)
from isa_ros.core.suggest import listed
from isa_ros.errors import SetpointError
from msg_adapters.cdr_reader import decode
from msg_adapters.joint_state import ARRAYS, entries, joint_state
from msg_adapters.template import Prepared, START_STAMP
import numpy as np
from sensor_msgs.msg import JointState

_APPLIED = {'stiffness': 'stiffness', 'damping': 'damping', 'enabled': 'is_enabled',
            'mode': 'mode', 'reference': 'reference', 'changed': 'kinds'}
"""Entries of an applied setpoint, and their fields of a `COMMAND`."""
_BEFORE_DEVICE = 4  # entries in a bag that was recorded before there were modes


def applied_names(name: str) -> list[str]:
    """Return the entries of an applied setpoint, in their order."""
    return [name, *(f'{name}/{entry}' for entry in _APPLIED)]


def applied_setpoint(name: str, columns: Mapping[str, int]) -> Prepared:
    """
    Return ``~/applied_setpoint`` of an actuator: all values in force from the tick's start on.

    ``columns`` are those of a COMMAND row with gains resolved, by field. All but the first entry
    have a number in ``position``; that of NAME/changed is the sum of the `HAS_*` of what changed,
    and `WAS_REFUSED` where the device refused to enable or disable.
    """
    names = applied_names(name)
    fields = entries(
        len(names), velocity=[columns['velocity']], effort=[columns['effort']],
        position=[columns['position'], *(columns[field] for field in _APPLIED.values())])
    return joint_state(name, names), {**fields, **START_STAMP}


def msg_to_command(message: JointState, name: str) -> np.void:
    """
    Return the COMMAND row of a setpoint for actuator ``name``.

    Entry NAME holds position, velocity and effort; the optional entries NAME/stiffness and
    NAME/damping a gain in ``position``. Missing velocity or effort is zero; a missing position is
    NaN, as are all three where they are NaN in the message: not given, which the mode in force
    may allow. A missing gain is NaN and leaves the gain in force unchanged. The entry NAME/current
    (amplifier A), NAME/spool (m) or NAME/pressure (Pa of difference) is the setpoint of that mode,
    and may be the only one.

    Raises
    ------
    SetpointError
        a name is unknown or occurs twice, the number of another entry than NAME is missing or not
        finite, a value is infinite, a gain is negative, there are references of two modes, or
        NAME has no number at all; the whole message is rejected.

    """
    names = list(message.name)
    references = [entry for entry in REFERENCES if f'{name}/{entry}' in names]
    if name not in names and not references:
        raise SetpointError(f'{name}: is not among the joints of the setpoint, {listed(names)}')
    _check(message, name, names)
    command: np.void = np.zeros(1, dtype=COMMAND)[0]
    if name in names:
        command['kinds'] = HAS_SETPOINT
        _fill_motion(message, name, names.index(name), command)
    for gain in GAINS_OF_COMMAND:
        entry = f'{name}/{gain}'
        command[gain] = message.position[names.index(entry)] if entry in names else math.nan
        if command[gain] < 0.0:
            raise SetpointError(f'{entry} = {command[gain]}, must be >= 0')
        if entry in names and name not in names:
            command['kinds'] = HAS_GAINS
    if len(references) > 1:
        raise SetpointError(
            f'{name}: setpoint has {" and ".join(references)}, must be the one of its mode')
    for entry in references:
        command['kinds'] |= HAS_REFERENCE
        command['mode'] = REFERENCES[entry]
        command['reference'] = message.position[names.index(f'{name}/{entry}')]
    return command


def msg_to_commands(message: JointState, joints: Sequence[str]) -> dict[str, np.void]:
    """
    Return the COMMAND row of each of ``joints`` that a message names, by its name.

    The entries of each joint are those of `msg_to_command`.

    Raises
    ------
    SetpointError
        As `msg_to_command`, or the message names no joint or others than ``joints``.

    """
    names = list(message.name)
    owners = [name.partition('/')[0] for name in names]
    unknown = [name for name, owner in zip(names, owners) if owner not in joints]
    if unknown or not names:
        raise SetpointError(
            f'setpoint names {listed(unknown)}, must name joints of {listed(joints)}')
    for field in ARRAYS:
        values = getattr(message, field)
        if len(values) not in (0, len(names)):
            raise SetpointError(
                f'setpoint has {len(values)} values of {field} for {len(names)} names')
    found = {}
    for joint in dict.fromkeys(owners):
        places = [k for k, owner in enumerate(owners) if owner == joint]
        found[joint] = msg_to_command(JointState(name=[names[k] for k in places], **{
            field: [values[k] for k in places]
            for field in ARRAYS if (values := getattr(message, field))}), joint)
    return found


def applied_to_command(data: bytes, name: str) -> np.void:
    """
    Return the COMMAND row of a recorded applied setpoint; inverse of `applied_setpoint`.

    Raises
    ------
    SetpointError
        the message is not an applied setpoint of ``name``, or a value is not finite.
    CdrError
        the bytes are not a JointState.

    """
    values = _recorded(data, name, 'applied', _BEFORE_DEVICE)
    for entry, value in values.items():
        _finite(f'{name}: applied {entry}', value)
    command = _row_of(values, name)
    if 'mode' in values:
        command['mode'] = _whole(f'{name}/mode', values['mode'], len(MODES) - 1)
        command['reference'] = values['reference']
        command['kinds'] = _whole(f'{name}/changed', values['changed'], EVERY_KIND | WAS_REFUSED)
    if int(command['kinds']) & WAS_REFUSED:
        command['kinds'] = int(command['kinds']) ^ WAS_REFUSED
        command['is_enabled'] = 1 - int(command['is_enabled'])
    return command


def applied_kinds(data: bytes, name: str) -> int:
    """
    Return what changed in a recorded applied setpoint: bits of `HAS_*`, and `WAS_REFUSED`.

    Raises
    ------
    SetpointError
        The message is not an applied setpoint of ``name``, or says not what changed.
    CdrError
        The bytes are not a JointState.

    """
    values = _recorded(data, name, 'applied')
    return _whole(f'{name}/changed', values['changed'], EVERY_KIND | WAS_REFUSED)


def sent_to_command(data: bytes, name: str) -> np.void:
    """
    Return the COMMAND row of a recorded sent setpoint; inverse of `applied_setpoint`.

    A mode, a reference and the kinds of what changed are numbers of the entries as they are; three
    NaN are no position, velocity and effort, and a gain that is NaN keeps the gain in force.

    Raises
    ------
    SetpointError
        the message is not a sent setpoint of ``name``, or a value is invalid.
    CdrError
        the bytes are not a JointState.

    """
    values = _recorded(data, name, 'sent')
    command = _row_of(values, name)
    kinds = _whole(f'{name}/changed', values['changed'], EVERY_KIND)
    if not kinds:
        raise SetpointError(f'{name}: sent setpoint without a value')
    if kinds & (HAS_SETPOINT | HAS_ENABLE) != command['kinds']:
        raise SetpointError(f'{name}/changed = {kinds}, must name the values that are not NaN')
    if kinds & (HAS_MODE | HAS_REFERENCE):
        command['mode'] = _whole(f'{name}/mode', values['mode'], len(MODES) - 1, 1)
    if kinds & HAS_REFERENCE:
        command['reference'] = _finite(f'{name}/reference', values['reference'])
    command['kinds'] = kinds
    return command


def _recorded(data: bytes, name: str, what: str, fewest: int | None = None) -> dict[str, float]:
    """
    Return the numbers of a recorded setpoint: of the first entry by array, of the others by entry.

    It may have the first ``fewest`` entries alone; None: it must have all.
    """
    message = decode(data, JointState)
    names = applied_names(name)
    n = len(message.name)
    if list(message.name) not in (names, names[:fewest]) or any(
            len(getattr(message, field)) != n for field in ARRAYS):
        raise SetpointError(
            f'{name}: {what} setpoint names {listed(message.name)}, must name {listed(names)} '
            'with all values of each')
    return {**{field: getattr(message, field)[0] for field in ARRAYS},
            **dict(zip(_APPLIED, message.position[1:]))}


def _row_of(values: Mapping[str, float], name: str) -> np.void:
    """Return the COMMAND row of those recorded motions, gains and states that are not NaN."""
    command: np.void = np.zeros(1, COMMAND)[0]
    if not all(math.isnan(values[field]) for field in ARRAYS):
        command['kinds'] = HAS_SETPOINT
        for field in ARRAYS:
            command[field] = _finite(f'{name}: recorded {field}', values[field])
    for gain in GAINS_OF_COMMAND:
        if math.isinf(values[gain]) or values[gain] < 0.0:
            raise SetpointError(f'{name}/{gain} = {values[gain]}, must be finite and >= 0, or NaN')
        command[gain] = values[gain]
    if not math.isnan(values['enabled']):
        command['kinds'] |= HAS_ENABLE
        command['is_enabled'] = _whole(f'{name}/enabled', values['enabled'], 1)
    return command


def _whole(what: str, value: float, most: int, least: int = 0) -> int:
    """Return a value that is a whole number >= ``least`` and <= ``most``."""
    if not (least <= value <= most and value == int(value)):
        raise SetpointError(f'{what} = {value}, must be a whole number of {least} to {most}')
    return int(value)


def _finite(what: str, value: float) -> float:
    """Return a value that is finite."""
    if not math.isfinite(value):
        raise SetpointError(f'{what} = {value}, must be finite')
    return value


def _fill_motion(message: JointState, name: str, k: int, command: np.void) -> None:
    """Fill position, velocity and effort of entry ``k``, of which one must be there."""
    if not any(getattr(message, field)[k:k + 1] for field in ARRAYS):
        raise SetpointError(f'{name}: setpoint has neither position, velocity nor effort')
    for field, absent in zip(ARRAYS, (math.nan, 0.0, 0.0)):
        values = getattr(message, field)
        command[field] = values[k] if k < len(values) else absent


def _check(message: JointState, name: str, names: list[str]) -> None:
    known = [name, *(f'{name}/{entry}' for entry in (*GAINS_OF_COMMAND, *REFERENCES))]
    unknown = [entry for entry in names if entry not in known]
    if unknown:
        raise SetpointError(
            f'{name}: unknown setpoint entries {listed(unknown)}, must be of {listed(known)}')
    if len(set(names)) != len(names):
        raise SetpointError(f'{name}: setpoint names an entry twice: {listed(names)}')
    n_positions = len(message.position)
    if n_positions != len(names) and (n_positions or names != [name]):
        raise SetpointError(
            f'{name}: setpoint has {n_positions} positions for {len(names)} names')
    for field in ARRAYS:
        values = getattr(message, field)
        if len(values) > len(names):
            raise SetpointError(
                f'{name}: setpoint has {len(values)} values of {field} for {len(names)} names')
        for k, value in enumerate(values):
            if names[k] != name or math.isinf(value):
                _finite(f'{names[k]}: setpoint {field}', value)
