"""
sensor_msgs/JointState ``~/sent_setpoint``: what was handed to the link of an actuator at a tick.

Its entries are those of an applied setpoint; a value that the command does not have is NaN.
"""

import math

from isa_ros.core.device import MODES
from isa_ros.core.signals import (
    COMMAND, EVERY_KIND, GAINS_OF_COMMAND, HAS_ENABLE, HAS_MODE, HAS_REFERENCE, HAS_SETPOINT)
from isa_ros.core.suggest import listed
from isa_ros.errors import SetpointError
from msg_adapters.cdr_reader import decode
from msg_adapters.joint_state import ARRAYS
from msg_adapters.setpoint import applied_names
import numpy as np
from sensor_msgs.msg import JointState


_ENABLED, _MODE, _REFERENCE, _CHANGED = 3, 4, 5, 6  # places of the entries


def sent_to_command(data: bytes, name: str) -> np.void:
    """
    Return the COMMAND row of a recorded sent setpoint; inverse of `setpoint.applied_setpoint`.

    Raises
    ------
    SetpointError
        the message is not a sent setpoint of ``name``, or a value is invalid.
    CdrError
        the bytes are not a JointState.

    """
    message = decode(data, JointState)
    names = applied_names(name)
    if list(message.name) != names or any(
            len(getattr(message, field)) != len(names) for field in ARRAYS):
        raise SetpointError(
            f'{name}: sent setpoint names {listed(message.name)}, must name {listed(names)} with '
            'all values of each')
    command: np.void = np.zeros(1, COMMAND)[0]
    _read_setpoint(message, name, command)
    _read_gains(message, name, command)
    enabled = message.position[_ENABLED]
    if not math.isnan(enabled):
        if enabled not in (0.0, 1.0):
            raise SetpointError(f'{names[_ENABLED]} = {enabled}, must be 0.0, 1.0 or NaN')
        command['kinds'] |= HAS_ENABLE
        command['is_enabled'] = int(enabled)
    _read_device(message, name, command)
    if not command['kinds']:
        raise SetpointError(f'{name}: sent setpoint without a value')
    return command


def _read_setpoint(message: JointState, name: str, command: np.void) -> None:
    """Read position, velocity and effort: three finite numbers, or three NaN."""
    values = [getattr(message, field)[0] for field in ARRAYS]
    if all(map(math.isnan, values)):
        return
    for field, value in zip(ARRAYS, values):
        if not math.isfinite(value):
            raise SetpointError(f'{name}: sent {field} = {value}, must be finite')
        command[field] = value
    command['kinds'] |= HAS_SETPOINT


def _read_gains(message: JointState, name: str, command: np.void) -> None:
    """Read the gains; NaN keeps the gain in force."""
    for k, gain in enumerate(GAINS_OF_COMMAND, 1):
        value = message.position[k]
        if math.isinf(value) or value < 0.0:
            raise SetpointError(f'{name}/{gain} = {value}, must be finite and >= 0, or NaN')
        command[gain] = value


def _read_device(message: JointState, name: str, command: np.void) -> None:
    """Read mode, reference and all kinds: whole numbers, and a finite reference."""
    mode, reference, kinds = (message.position[k] for k in (_MODE, _REFERENCE, _CHANGED))
    if not (0 <= kinds <= EVERY_KIND and kinds == int(kinds)):
        raise SetpointError(
            f'{name}/changed = {kinds}, must be a whole number <= {EVERY_KIND}')
    read, kinds = int(command['kinds']), int(kinds)
    if kinds & (HAS_SETPOINT | HAS_ENABLE) != read:
        raise SetpointError(f'{name}/changed = {kinds}, must name the values that are not NaN')
    if kinds & (HAS_MODE | HAS_REFERENCE):
        if not (0 < mode < len(MODES) and mode == int(mode)):
            raise SetpointError(
                f'{name}/mode = {mode}, must be a whole number > 0 and < {len(MODES)}')
        command['mode'] = int(mode)
    if kinds & HAS_REFERENCE:
        if not math.isfinite(reference):
            raise SetpointError(f'{name}/reference = {reference}, must be finite')
        command['reference'] = reference
    command['kinds'] = kinds
