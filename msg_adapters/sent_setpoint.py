"""
sensor_msgs/JointState ``~/sent_setpoint``: what was handed to the link of an actuator at a tick.

Its entries are those of an applied setpoint; a value that the command does not have is NaN.
"""

from collections.abc import Mapping
import math

from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_GAINS, HAS_SETPOINT
from isa_ros.core.suggest import listed
from isa_ros.errors import SetpointError
from msg_adapters.cdr_reader import decode
from msg_adapters.joint_state import ARRAYS
from msg_adapters.setpoint import applied_setpoint, GAINS
from msg_adapters.template import Prepared
import numpy as np
from sensor_msgs.msg import JointState


def sent_setpoint(name: str, columns: Mapping[str, int]) -> Prepared:
    """Return the message of an actuator; ``columns`` as in `applied_setpoint`."""
    return applied_setpoint(name, columns)


def sent_to_command(data: bytes, name: str) -> np.void:
    """
    Return the COMMAND row of a recorded sent setpoint; inverse of `sent_setpoint`.

    Raises
    ------
    SetpointError
        the message is not a sent setpoint of ``name``, or a value is invalid.
    CdrError
        the bytes are not a JointState.

    """
    message = decode(data, JointState)
    names = [name, *(f'{name}/{gain}' for gain in GAINS), f'{name}/enabled']
    if list(message.name) != names or any(
            len(getattr(message, field)) != len(names) for field in ARRAYS):
        raise SetpointError(
            f'{name}: sent setpoint names {listed(message.name)}, must name {listed(names)} with '
            'all values of each')
    command: np.void = np.zeros(1, COMMAND)[0]
    _read_setpoint(message, name, command)
    _read_gains(message, name, command)
    enabled = message.position[-1]
    if not math.isnan(enabled):
        if enabled not in (0.0, 1.0):
            raise SetpointError(f'{names[-1]} = {enabled}, must be 0.0, 1.0 or NaN')
        command['kinds'] |= HAS_ENABLE
        command['is_enabled'] = int(enabled)
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
    for k, gain in enumerate(GAINS, 1):
        value = message.position[k]
        if math.isinf(value) or value < 0.0:
            raise SetpointError(f'{name}/{gain} = {value}, must be finite and >= 0, or NaN')
        command[gain] = value
        if not math.isnan(value):
            command['kinds'] |= HAS_GAINS
