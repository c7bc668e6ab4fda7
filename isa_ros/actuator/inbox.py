"""What waits for the next tick of an actuator: a `COMMAND` row, filled by several."""

from isa_ros.actuator.tunable import GAINS
from isa_ros.core.signals import HAS_ENABLE, HAS_GAINS, HAS_SETPOINT
import numpy as np

_MOTION = ('position', 'velocity', 'effort')
_WITH_GAINS = HAS_SETPOINT | HAS_GAINS


def merge(pending: np.record, command: np.void) -> None:
    """Add a command: of several the last wins, and a gain left NaN keeps the one before."""
    kinds = int(command['kinds'])
    if kinds & HAS_SETPOINT:
        for name in _MOTION:
            pending[name] = command[name]
    if kinds & _WITH_GAINS:
        was_pending = int(pending.kinds) & _WITH_GAINS
        for name in GAINS.values():
            if not (was_pending and np.isnan(command[name])):
                pending[name] = command[name]
    if kinds & HAS_ENABLE:
        pending.is_enabled = command['is_enabled']
    pending.kinds |= kinds


def take(pending: np.record, reu: np.record) -> None:
    """Let it take effect on a `REU_STATE`; enabled anew, the actuator holds where it is."""
    kinds, setpoint = int(pending.kinds), reu.setpoint
    if kinds & HAS_ENABLE:
        if pending.is_enabled and not setpoint.is_enabled:
            setpoint.position = reu.measured.position
            setpoint.velocity = setpoint.effort = 0.0
        setpoint.is_enabled = float(pending.is_enabled)
    if kinds & HAS_SETPOINT:
        for name in _MOTION:
            setpoint[name] = pending[name]
    if kinds & _WITH_GAINS:
        for name in GAINS.values():
            setpoint[name] = gain_after(name, pending, reu)
    pending.kinds = 0


def gain_after(name: str, pending: np.record, reu: np.record) -> float:
    """Return a gain of `COMMAND` as it will be once ``pending`` is taken."""
    is_new = int(pending.kinds) & _WITH_GAINS and not np.isnan(pending[name])
    return float((pending if is_new else reu.setpoint)[name])
