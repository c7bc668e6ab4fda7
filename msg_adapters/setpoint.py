"""Conversion of setpoints and applied setpoints: JointState <-> COMMAND row."""

from collections.abc import Mapping, Sequence
import math

from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_SETPOINT
from isa_ros.core.suggest import listed
from isa_ros.errors import SetpointError
from msg_adapters.cdr_reader import decode
from msg_adapters.joint_state import ARRAYS, entries, joint_state
from msg_adapters.template import Prepared, START_STAMP
import numpy as np
from sensor_msgs.msg import JointState

GAINS = ('stiffness', 'damping')


def applied_setpoint(name: str, columns: Mapping[str, int]) -> Prepared:
    """
    Return ``~/applied_setpoint`` of an actuator: all values in force from the tick's start on.

    ``columns`` are those of a COMMAND row with gains resolved, by field.
    """
    names = [name, *(f'{name}/{gain}' for gain in GAINS), f'{name}/enabled']
    fields = entries(
        len(names), velocity=[columns['velocity']], effort=[columns['effort']],
        position=[columns[field] for field in ('position', *GAINS, 'is_enabled')])
    return joint_state(name, names), {**fields, **START_STAMP}


def msg_to_command(message: JointState, name: str) -> np.void:
    """
    Return the COMMAND row of a setpoint for actuator ``name``.

    Entry NAME holds position, velocity and effort; the optional entries NAME/stiffness and
    NAME/damping a gain in ``position``. Missing velocity or effort is zero, a missing gain
    is NaN and leaves the gain in force unchanged.

    Raises
    ------
    SetpointError
        a name is unknown or occurs twice, a position is missing, a value is not finite, or a
        gain is negative; the whole message is rejected.

    """
    return _command(message, name, [name, *(f'{name}/{gain}' for gain in GAINS)])


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
    enabled = f'{name}/enabled'
    names = [name, *(f'{name}/{gain}' for gain in GAINS), enabled]
    if list(message.name) != names:
        raise SetpointError(
            f'{name}: applied setpoint names {listed(message.name)}, must name {listed(names)}')
    command = _command(message, name, names)
    value = message.position[names.index(enabled)]
    if value not in (0.0, 1.0):
        raise SetpointError(f'{enabled} = {value}, must be 0.0 or 1.0')
    command['kinds'] |= HAS_ENABLE
    command['is_enabled'] = int(value)
    return command


def _command(message: JointState, name: str, known: Sequence[str]) -> np.void:
    names = list(message.name)
    if name not in names:
        raise SetpointError(f'{name}: is not among the joints of the setpoint, {listed(names)}')
    _check(message, name, names, known)
    command: np.void = np.zeros(1, dtype=COMMAND)[0]
    k = names.index(name)
    command['kinds'] = HAS_SETPOINT
    for field in ARRAYS:
        values = getattr(message, field)
        command[field] = values[k] if k < len(values) else 0.0
    for gain in GAINS:
        entry = f'{name}/{gain}'
        command[gain] = message.position[names.index(entry)] if entry in names else math.nan
        if command[gain] < 0.0:
            raise SetpointError(f'{entry} = {command[gain]}, must be >= 0')
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
