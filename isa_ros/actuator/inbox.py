"""
Pending commands of an actuator: accepted between two ticks, in force from the next one.

One `COMMAND` row per actuator holds them. Topics, services, scenarios and controllers all add to
it with `merge`; `latch` applies it at the start of a tick.
"""

import math

from isa_ros.core.device import ENABLED
from isa_ros.core.kernel import kernel
from isa_ros.core.signals import (
    EVERY_KIND, HAS_ENABLE, HAS_GAINS, HAS_MODE, HAS_REFERENCE, HAS_SETPOINT, WAS_REFUSED)
from isa_ros.reu.bumpless import EVERY_BLOCK
from isa_ros.reu.device import is_enabled
from isa_ros.reu.protection import feed
from isa_ros.reu.stops import stay_here

WITH_GAINS = HAS_SETPOINT | HAS_GAINS
"""Kinds of commands that may contain gains."""

NO_REFERENCE = EVERY_KIND ^ HAS_REFERENCE


@kernel
def merge(command, pending):
    """
    Add a command: the last of several wins; a gain of NaN leaves the pending one unchanged.

    A reference for another mode than the pending one is discarded.
    """
    kinds = command.kinds
    if kinds & HAS_SETPOINT:
        pending.position = command.position
        pending.velocity = command.velocity
        pending.effort = command.effort
        pending.kinds &= NO_REFERENCE
    if kinds & WITH_GAINS:
        is_first = not pending.kinds & WITH_GAINS
        if is_first or not math.isnan(command.stiffness):
            pending.stiffness = command.stiffness
        if is_first or not math.isnan(command.damping):
            pending.damping = command.damping
    if kinds & HAS_ENABLE:
        pending.is_enabled = command.is_enabled
    if kinds & HAS_MODE and pending.mode != command.mode:
        pending.kinds &= NO_REFERENCE
        pending.mode = command.mode
    if kinds & HAS_REFERENCE:
        if not pending.kinds & HAS_MODE:
            pending.mode = command.mode
        if pending.mode == command.mode:
            pending.reference = command.reference
        else:
            kinds &= NO_REFERENCE
    pending.kinds |= kinds


@kernel
def latch(pending, reu, applied):
    """
    Apply the pending command to a `REU_STATE` and copy it to ``applied``; without one, kinds is 0.

    An actuator that is enabled again holds its last measured position and force. The device takes
    mode, enable and requests at its next step.
    """
    setpoint, device = reu.setpoint, reu.status
    applied.kinds = 0
    if not pending.kinds:
        return
    if pending.kinds & HAS_MODE:
        device.requested_mode = pending.mode
    if pending.kinds & HAS_REFERENCE and pending.mode != device.requested_mode:
        pending.kinds &= NO_REFERENCE
    kinds = pending.kinds
    if kinds & HAS_ENABLE:
        if pending.is_enabled and device.state != ENABLED:
            stay_here(device.requested_mode, reu)
        device.requested_enable = int(pending.is_enabled)
    if kinds & HAS_SETPOINT:
        setpoint.position = pending.position
        setpoint.velocity = pending.velocity
        setpoint.effort = pending.effort
        setpoint.is_reference = 0.0
    if kinds & WITH_GAINS:
        if not math.isnan(pending.stiffness):
            setpoint.stiffness = pending.stiffness
        if not math.isnan(pending.damping):
            setpoint.damping = pending.damping
        if not kinds & HAS_SETPOINT and device.is_on:
            device.fade.begins = EVERY_BLOCK
    if kinds & HAS_REFERENCE:
        setpoint.reference = pending.reference
        setpoint.is_reference = 1.0
    if kinds & (HAS_SETPOINT | HAS_REFERENCE):
        feed(reu.protection)
    device.requests |= kinds
    pending.kinds = 0
    write_applied(kinds, reu, applied)


@kernel
def lose_pending(pending, applied):
    """Drop the pending command: a program that has stopped takes none, and counts none."""
    applied.kinds = pending.kinds = 0


@kernel
def write_applied(kinds, reu, applied):
    """
    Fill a `COMMAND` row with all values in force; ``kinds`` are those that changed.

    Mode and enable are those requested, where the command has them.
    """
    setpoint, device = reu.setpoint, reu.status
    applied.kinds = kinds
    applied.is_enabled = is_enabled(device)
    if kinds & HAS_ENABLE:
        applied.is_enabled = device.requested_enable
    applied.position, applied.velocity = setpoint.position, setpoint.velocity
    applied.effort = setpoint.effort
    applied.stiffness, applied.damping = setpoint.stiffness, setpoint.damping
    applied.mode, applied.reference = device.requested_mode, setpoint.reference


@kernel
def settle(device, applied):
    """
    End a tick: let ``applied`` say whether the device is enabled, after its trips and refusals.

    What a command asked for can be read from it too, for a replay: a request that was refused
    has `WAS_REFUSED`, and the opposite in ``is_enabled``.
    """
    if applied.kinds:
        if not applied.kinds & HAS_ENABLE:
            applied.is_enabled = is_enabled(device)
        elif device.refused & HAS_ENABLE:
            applied.is_enabled = 1 - device.requested_enable
            applied.kinds |= WAS_REFUSED
    device.refused = 0
