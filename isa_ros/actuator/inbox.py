"""
Pending commands of an actuator: accepted between two ticks, in force from the next one.

One `COMMAND` row per actuator holds them. Topics, services, scenarios and controllers all add to
it with `merge`; `latch` applies it at the start of a tick.
"""

import math

from isa_ros.core.kernel import kernel
from isa_ros.core.signals import HAS_ENABLE, HAS_GAINS, HAS_SETPOINT
from isa_ros.reu.protection import feed, request_clear

WITH_GAINS = HAS_SETPOINT | HAS_GAINS
"""Kinds of commands that may contain gains."""


@kernel
def merge(command, pending):
    """Add a command: the last of several wins; a gain of NaN leaves the pending one unchanged."""
    kinds = command.kinds
    if kinds & HAS_SETPOINT:
        pending.position = command.position
        pending.velocity = command.velocity
        pending.effort = command.effort
    if kinds & WITH_GAINS:
        is_first = not pending.kinds & WITH_GAINS
        if is_first or not math.isnan(command.stiffness):
            pending.stiffness = command.stiffness
        if is_first or not math.isnan(command.damping):
            pending.damping = command.damping
    if kinds & HAS_ENABLE:
        pending.is_enabled = command.is_enabled
    pending.kinds |= kinds


@kernel
def latch(pending, reu, applied):
    """
    Apply the pending command to a `REU_STATE` and copy it to ``applied``; without one, kinds is 0.

    An actuator that is enabled again holds its last measured position; trips whose condition has
    ended are cleared.
    """
    kinds, setpoint = pending.kinds, reu.setpoint
    applied.kinds = kinds
    if not kinds:
        return
    if kinds & HAS_ENABLE:
        if pending.is_enabled and setpoint.is_enabled == 0.0:
            setpoint.position = reu.measured.position
            setpoint.velocity = 0.0
            setpoint.effort = 0.0
        setpoint.is_enabled = float(pending.is_enabled)
        if pending.is_enabled:
            request_clear(reu.protection)
    if kinds & HAS_SETPOINT:
        setpoint.position = pending.position
        setpoint.velocity = pending.velocity
        setpoint.effort = pending.effort
        feed(reu.protection)
    if kinds & WITH_GAINS:
        if not math.isnan(pending.stiffness):
            setpoint.stiffness = pending.stiffness
        if not math.isnan(pending.damping):
            setpoint.damping = pending.damping
    pending.kinds = 0
    write_applied(kinds, setpoint, applied)


@kernel
def write_applied(kinds, setpoint, applied):
    """Fill a `COMMAND` row with all values in force; ``kinds`` are those that changed."""
    applied.kinds = kinds
    applied.is_enabled = int(setpoint.is_enabled)
    applied.position, applied.velocity = setpoint.position, setpoint.velocity
    applied.effort = setpoint.effort
    applied.stiffness, applied.damping = setpoint.stiffness, setpoint.damping
