"""
Commands on their way to an actuator: accepted between two ticks, in force from the next one.

A `COMMAND` row holds what waits. Topics, services, scenarios and controllers all add to it with
`merge`; `latch` lets it take effect at the start of a tick.
"""

import math

from isa_ros.core.kernel import kernel
from isa_ros.core.signals import HAS_ENABLE, HAS_GAINS, HAS_SETPOINT

WITH_GAINS = HAS_SETPOINT | HAS_GAINS
"""Kinds of a command that may hold gains."""


@kernel
def merge(command, pending):
    """Add a command: of several the last wins, and a gain that is NaN keeps the one before."""
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
    Let what waits take effect on a `REU_STATE`, and note it in ``applied``, of no kind for none.

    Enabled anew, the actuator holds the position it measured last.
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
    if kinds & HAS_SETPOINT:
        setpoint.position = pending.position
        setpoint.velocity = pending.velocity
        setpoint.effort = pending.effort
    if kinds & WITH_GAINS:
        if not math.isnan(pending.stiffness):
            setpoint.stiffness = pending.stiffness
        if not math.isnan(pending.damping):
            setpoint.damping = pending.damping
    pending.kinds = 0
    note_applied(kinds, setpoint, applied)


@kernel
def note_applied(kinds, setpoint, applied):
    """Fill a `COMMAND` row with everything that is in force; ``kinds`` is what is new of it."""
    applied.kinds = kinds
    applied.is_enabled = int(setpoint.is_enabled)
    applied.position, applied.velocity = setpoint.position, setpoint.velocity
    applied.effort = setpoint.effort
    applied.stiffness, applied.damping = setpoint.stiffness, setpoint.damping
