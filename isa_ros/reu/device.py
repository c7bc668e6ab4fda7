"""
The device of an actuator: its states, what changes them, and whether the blocks have the valve.

The states follow CiA 402. Only `enabled`, and the movement of a stop, have the outputs on; in all
other states the valve is commanded to null. A quick stop brings the movement to rest with the
declared deceleration (`isa_ros.reu.stops`), holds it, and ends disabled; or it closes the valve at
once, or stays at rest until it is disabled or enabled. A trip of a protection starts its reaction,
a quick stop or the outputs off, and ends in `fault`, which is kept until it is cleared, and
cleared only once its cause is gone. A trip whose reaction is hold stops in the same way, but stays
enabled; it is over no sooner than the load stands. `isa_ros.reu.transitions` has the whole table;
the kernel reads it as numbers.

Signs and units are those of the cascade.
"""

from isa_ros.core.device import (
    CLEAR, DISABLE, EMERGENCY_STOP, ENABLE, ENABLED, EVENTS, FAULT_REACTION, INITIALISING, MODE,
    NO_MODE, POSITION, QUICK_STOP, REACTION_ENDS, READY, SPOOL, STOP, STOP_ENDS, TRIP)
from isa_ros.core.kernel import kernel
from isa_ros.core.signals import (
    HAS_CLEAR_FAULT, HAS_ENABLE, HAS_MODE, HAS_QUICK_STOP, HAS_REFERENCE, HAS_SETPOINT)
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.reu.block_drive import open_lines
from isa_ros.reu.bumpless import EVERY_BLOCK, start_setpoint, take_over
from isa_ros.reu.flow_stop import has_stood, stands, watch_load
from isa_ros.reu.protection import (
    DAMP as REACTS_BY_DAMP, DISABLE as REACTS_BY_DISABLE, GONE, HOLD as REACTS_BY_HOLD,
    QUICK_STOP as REACTS_BY_QUICK_STOP, request_clear, TAKEN)
from isa_ros.reu.reactions import is_cause_gone
from isa_ros.reu.stops import advance_return, advance_stop, begin_return, begin_stop, stay_here


@kernel
def happens(event, guard, step, reu, own):
    """Let an event happen in a `DEVICE_STATE`; return whether the table has a row for it."""
    following = reu.rules.next[2 * (own.state * len(EVENTS) + event) + guard]
    if following < 0:
        return False
    own.state, own.event, own.since_step = following, event, step
    return True


@kernel
def take_conditions(step, reu, state):
    """React to what the protection has found."""
    own, found = state.status, state.protection
    if found.warnings != own.warnings or found.trips != own.trips:
        own.warnings, own.trips, own.since_step = found.warnings, found.trips, step
    if found.reaction < REACTS_BY_QUICK_STOP:
        return
    happens(TRIP, 0, step, reu, own)
    if own.state == FAULT_REACTION and found.reaction >= REACTS_BY_DISABLE:
        happens(REACTION_ENDS, 0, step, reu, own)


@kernel
def is_enabled(own):
    """Return 1 if a `DEVICE_STATE` is enabled, or will be once it is initialised, else 0."""
    return int(own.state == ENABLED or (own.state == INITIALISING and own.auto_enable != 0))


@kernel
def refuse(kind, own):
    """Count a request that the state has no transition for."""
    own.refused |= kind
    own.refused_requests += 1


@kernel
def take_requests(step, reu, state):
    """Execute the commands that took effect since the last step."""
    own = state.status
    if own.requests & HAS_CLEAR_FAULT:
        is_gone = int(is_cause_gone(reu.protection, state))
        if happens(CLEAR, is_gone, step, reu, own):
            request_clear(state.protection)
        else:
            refuse(HAS_CLEAR_FAULT, own)
    if own.requests & HAS_MODE and own.requested_mode != own.mode:
        if happens(MODE, reu.rules.modes >> own.requested_mode & 1, step, reu, own):
            own.mode = own.requested_mode
            own.is_returning = 0
            if own.is_stopping and not own.requests & (HAS_SETPOINT | HAS_REFERENCE):
                stay_here(own.mode, state)
        own.requested_mode = own.mode
    if own.requests & HAS_ENABLE:
        own.refused &= ~HAS_ENABLE
        event = ENABLE if own.requested_enable else DISABLE
        is_possible = may_enable(reu.rules, state.protection, own)
        if happens(event, int(is_possible), step, reu, own) and own.state == INITIALISING:
            own.auto_enable = own.requested_enable
        if own.requested_enable != is_enabled(own):
            refuse(HAS_ENABLE, own)
    if own.requests & HAS_QUICK_STOP:
        if not happens(STOP, 0, step, reu, own):
            refuse(HAS_QUICK_STOP, own)
        elif own.state == INITIALISING:
            own.auto_enable = 0
    if own.requests & (HAS_SETPOINT | HAS_REFERENCE) and (
            not is_enabled(own) or own.is_stopping or state.protection.reaction >= REACTS_BY_HOLD):
        own.unused_setpoints += 1


@kernel
def may_enable(rules, found, own):
    """
    Return whether a `DEVICE_STATE` may be enabled.

    No emergency stop is open, what it took of the supply's pressure is back, and a quick stop is
    at rest. ``found`` is a `PROTECTION_STATE`.
    """
    return (rules.emergency_stop == 0.0 and found.supply_taken != GONE
            and (own.state != QUICK_STOP or is_held(rules, own)))


@kernel
def is_held(rules, own):
    """Return whether a quick stop of a `DEVICE_STATE` stays at rest and may be left by enable."""
    return rules.stays == 1 and own.is_stopping == 1 and stands(rules.flow, own.flow)


@kernel
def stops(device_state):
    """Return whether a state stops the movement."""
    return device_state == QUICK_STOP or device_state == FAULT_REACTION


@kernel
def is_over(rules, own):
    """Return whether a stop was at rest long enough, or closes the valve."""
    if rules.stays == 1 and own.state == QUICK_STOP and rules.emergency_stop == 0.0:
        return False
    return (rules.ramps == 0 or own.is_stopping == 0
            or has_stood(rules.hold, rules.flow, own.flow))


@kernel
def let_act(step, entered, reu, state):
    """
    Let the blocks of the state and mode act, bumpless; ``entered`` is the state before.

    The valve gets no current before the block valves are open.
    """
    own, rules, reaction = state.status, reu.rules, state.protection.reaction
    was_on, was_stopping, was_damping = own.is_on, own.is_stopping, own.is_damping
    acts = own.state == ENABLED
    still_moves = (was_stopping == 1 and reaction < REACTS_BY_HOLD
                   and not stands(rules.flow, own.flow))
    brakes = stops(own.state) and rules.ramps == 1
    is_open = open_lines(acts or brakes, reaction, step, rules, own)
    own.is_open = int(is_open)
    own.is_stopping = int(is_open and (
        acts and (reaction == REACTS_BY_HOLD or still_moves) or brakes))
    own.is_damping = int(acts and reaction == REACTS_BY_DAMP)
    own.is_on = int(is_open and (acts or brakes))
    acting = SPOOL if own.is_stopping else own.mode
    if not own.is_on:
        if was_on and not was_stopping:
            own.flow.slow_force = state.measured.force
        own.fade.begins = own.fade.is_on = own.is_returning = 0
    elif not was_on and entered == INITIALISING and rules.initialisation == 0.0:
        pass  # at t = 0 the blocks are at rest already
    elif not was_on or own.is_stopping != was_stopping or acting != own.acting:
        take_over_bumpless(acting, was_on, was_stopping, reu, state)
    if own.is_stopping and not was_stopping:
        own.is_returning = 0
        begin_stop(rules, state)
    elif was_on and own.mode >= POSITION and acts and not own.is_stopping:
        if was_stopping and not own.is_damping:
            begin_return(own.flow.slow_force, state)
        elif was_damping and not own.is_damping:
            begin_return(0.0, state)
    own.acting = acting


@kernel
def take_over_bumpless(acting, was_on, was_stopping, reu, state):
    """Start the blocks of a mode at the present references, without a jump of the current."""
    own = state.status
    reference = take_over(own.acting if was_on else NO_MODE, acting, reu, state)
    own.fade.begins = EVERY_BLOCK
    if (was_on and not own.is_stopping and not was_stopping
            and not own.requests & (HAS_SETPOINT | HAS_REFERENCE)):
        start_setpoint(acting, reference, state)


@kernel
def get_ready(step, reu, state):
    """End the initialisation; an actuator without a setpoint stays and bears its load."""
    own = state.status
    happens(READY, own.auto_enable, step, reu, own)
    if own.state == ENABLED and state.protection.setpoint_age == 0:
        if reu.rules.initialisation == 0.0:
            own.flow.slow_force = state.measured.force
        stay_here(own.mode, state)


@kernel
def device_step(step, reu, state):
    """Run the device at one conversion, before the blocks."""
    own, found = state.status, state.protection
    if (own.state == ENABLED and own.is_on == 1 and own.requests == 0
            and reu.rules.emergency_stop == 0.0 and own.warnings == found.warnings
            and own.trips == found.trips and found.reaction < REACTS_BY_HOLD
            and own.is_stopping + own.is_damping + own.is_returning == 0):
        return
    entered = own.state
    if not own.is_on:
        watch_load(state.measured.force, reu.rules.flow, own.flow)
    if reu.rules.emergency_stop > 0.0:
        found.supply_taken = max(found.supply_taken, TAKEN)
        if is_enabled(own) == 1:
            happens(EMERGENCY_STOP, 0, step, reu, own)
            own.auto_enable = 0
    if entered == INITIALISING and step * PLANT_STEP >= reu.rules.initialisation:
        get_ready(step, reu, state)
    take_conditions(step, reu, state)
    if own.requests:
        take_requests(step, reu, state)
    if own.is_stopping:
        advance_stop(reu.rules, state)
    if stops(entered) and stops(own.state) and is_over(reu.rules, own):
        happens(STOP_ENDS if own.state == QUICK_STOP else REACTION_ENDS, 0, step, reu, own)
    let_act(step, entered, reu, state)
    if own.is_returning:
        advance_return(reu.rules, state)
    own.requests = 0


@kernel
def write_device(own, sample):
    """Write state, mode, event, since when (s), and counts of a run into a `SAMPLE`."""
    sample.device_state, sample.device_mode = own.state, own.mode
    sample.device_event = own.event
    sample.state_since = own.since_step * PLANT_STEP
    sample.unused_setpoints = float(own.unused_setpoints)
    sample.refused_requests = float(own.refused_requests)
