"""Conversion of setpoints and applied setpoints: JointState <-> COMMAND row."""

from collections.abc import Mapping, Sequence
import math

from isa_ros.core.device import MODES, REFERENCES
from isa_ros.core.signals import (
    COMMAND, EVERY_KIND, GAINS_OF_COMMAND, HAS_ENABLE, HAS_GAINS, HAS_REFERENCE, HAS_SETPOINT)
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
    have a number in ``position``; that of NAME/changed is the sum of the `HAS_*` of what changed.
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
    NAME/damping a gain in ``position``. Missing velocity or effort is zero, a missing gain
    is NaN and leaves the gain in force unchanged. The entry NAME/current (amplifier A),
    NAME/spool (m) or NAME/pressure (Pa of difference) is the setpoint of that mode, and may be
    the only one.

    Raises
    ------
    SetpointError
        a name is unknown or occurs twice, a position is missing, a value is not finite, a gain
        is negative, or there are references of two modes; the whole message is rejected.

    """
    return _command(message, name, [
        name, *(f'{name}/{entry}' for entry in (*GAINS_OF_COMMAND, *REFERENCES))])


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
    message = decode(data, JointState)
    names = applied_names(name)
    if list(message.name) not in (names, names[:_BEFORE_DEVICE]):
        raise SetpointError(
            f'{name}: applied setpoint names {listed(message.name)}, must name {listed(names)}')
    command = _command(message, name, names)
    command['kinds'] = HAS_SETPOINT | HAS_ENABLE
    values = dict(zip(_APPLIED, message.position[1:]))
    for entry, most in (('enabled', 1), ('mode', len(MODES) - 1), ('changed', EVERY_KIND)):
        value = values.get(entry, 0.0)
        if not (0 <= value <= most and value == int(value)):
            raise SetpointError(f'{name}/{entry} = {value}, must be a whole number <= {most}')
        if entry in values:
            command[_APPLIED[entry]] = int(value)
    command['reference'] = values.get('reference', 0.0)
    return command


def _command(message: JointState, name: str, known: Sequence[str]) -> np.void:
    names = list(message.name)
    references = [entry for entry in REFERENCES if f'{name}/{entry}' in names]
    if name not in names and not references:
        raise SetpointError(f'{name}: is not among the joints of the setpoint, {listed(names)}')
    _check(message, name, names, known)
    command: np.void = np.zeros(1, dtype=COMMAND)[0]
    if name in names:
        k = names.index(name)
        command['kinds'] = HAS_SETPOINT
        for field in ARRAYS:
            values = getattr(message, field)
            command[field] = values[k] if k < len(values) else 0.0
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


def _check(message: JointState, name: str, names: list[str], known: Sequence[str]) -> None:
    unknown = [entry for entry in names if entry not in known]
    if unknown:
        raise SetpointError(
            f'{name}: unknown setpoint entries {listed(unknown)}, must be of {listed(known)}')
    if len(set(names)) != len(names):
        raise SetpointError(f'{name}: setpoint names an entry twice: {listed(names)}')
    if len(message.position) != len(names):
        raise SetpointError(
            f'{name}: setpoint has {len(message.position)} positions for {len(names)} names')
    for field in ARRAYS:
        values = getattr(message, field)
        if len(values) > len(names):
            raise SetpointError(
                f'{name}: setpoint has {len(values)} values of {field} for {len(names)} names')
        for k, value in enumerate(values):
            if not math.isfinite(value):
                raise SetpointError(f'{names[k]}: setpoint {field} = {value}, must be finite')
