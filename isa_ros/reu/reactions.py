"""
The reactions of the REU to its trips, and what they put in place of a user's commands.

Each conversion is measured and judged by `isa_ros.reu.protection`, then the strongest reaction of
all trips acts. The device of `isa_ros.reu.device` stops quickly, or disables.
"""

from isa_ros.core.kernel import kernel
from isa_ros.reu.plausibility import acceleration_step
from isa_ros.reu.protection import (
    BIT, DAMP, EXTENDING, judge, LIMIT, measure, N, NONE, QUICK_STOP, reaction_of,
    RETRACTING)


@kernel
def worsening(k, velocity, measured, stroke):
    """Return the direction in which a command of the valve makes condition ``k`` worse."""
    if k == BIT.end_of_stroke:
        extends = measured.position > 0.5 * stroke
    elif k == BIT.overspeed:
        extends = velocity > 0.0
    elif k == BIT.overload:
        extends = measured.force > 0.0
    else:
        extends = measured.pressure_a > measured.pressure_b
    return EXTENDING if extends else RETRACTING


@kernel
def react(protection, state):
    """
    Take the strongest reaction of the trips of a `REU_STATE`.

    damp: an impedance without stiffness at the measured position. The device reacts to hold,
    quick_stop, disable and block.
    """
    own = state.protection
    own.reaction, own.inhibited = NONE, 0
    for k in range(N):
        if own.trips >> k & 1:
            own.reaction = max(own.reaction, reaction_of(k, state.status.mode, protection))
            if protection.reaction[k] == LIMIT:
                own.inhibited |= worsening(
                    k, state.speed.velocity, state.measured, protection.stroke)
    if own.reaction == DAMP:
        own.setpoint.position = state.measured.position
        own.setpoint.damping = state.setpoint.damping


@kernel
def protect(step, supply_pressure, temperature, protection, state):
    """Measure, judge and react at one conversion; ``state`` is a `REU_STATE`."""
    own = state.protection
    acceleration_step(step, state.speed.velocity, protection.evidence, own.evidence)
    measure(supply_pressure, temperature, protection, state)
    judge(step, state.status.mode, protection, own)
    if own.trips != 0 or own.reaction != NONE:
        react(protection, state)


@kernel
def setpoint_in_force(state):
    """Return the setpoint that the blocks of a `REU_STATE` follow: its own, or one before it."""
    if state.status.is_stopping:
        return state.status.stop
    if state.protection.reaction == DAMP:
        return state.protection.setpoint
    if state.status.is_returning:
        return state.status.back
    return state.setpoint


@kernel
def is_inhibited(command, own):
    """Return whether a command of the valve is in a direction that a reaction inhibits."""
    return (command > 0.0 and own.inhibited & EXTENDING != 0
            or command < 0.0 and own.inhibited & RETRACTING != 0)


@kernel
def is_cause_gone(protection, state):
    """Return whether the condition of every trip that stops the actuator has ended."""
    for k in range(N):
        if state.protection.present >> k & 1 and (
                reaction_of(k, state.status.mode, protection) >= QUICK_STOP):
            return False
    return True
