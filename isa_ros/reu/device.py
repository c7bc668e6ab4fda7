"""
The device of an actuator: its states, what changes them, and whether the blocks have the valve.

The states follow CiA 402. Only `enabled`, and the movement of a stop, have the outputs on; in all
other states the valve is commanded to null. A quick stop brings the reference of the position
block to rest with the declared deceleration (or at once), holds it, and ends disabled. A trip of a
protection starts its reaction, a quick stop or the outputs off, and ends in `fault`, which is kept
until it is cleared, and cleared only once its cause is gone. `TRANSITIONS` is the whole table; the
kernel reads it as numbers, `docs/device.md` shows it.

Signs and units are those of the cascade.
"""

from typing import NamedTuple

from isa_ros.core.device import (
    CLEAR, DISABLE, DISABLED, ENABLE, ENABLED, EVENTS, FAULT, FAULT_REACTION, FORCE, INITIALISING,
    MODE, NO_MODE, QUICK_STOP, REACTION_ENDS, READY, STATES, STOP, STOP_ENDS, TRIP)
from isa_ros.core.elementary import exp
from isa_ros.core.kernel import kernel
from isa_ros.core.record import record
from isa_ros.core.signals import (
    HAS_CLEAR_FAULT, HAS_ENABLE, HAS_MODE, HAS_QUICK_STOP, HAS_REFERENCE, HAS_SETPOINT)
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.reu.bumpless import FADE, start_setpoint, take_over
from isa_ros.reu.impedance import SETPOINT
from isa_ros.reu.protection import DISABLE as REACTS_BY_DISABLE, HOLD as REACTS_BY_HOLD
from isa_ros.reu.protection import QUICK_STOP as REACTS_BY_QUICK_STOP, request_clear
from isa_ros.reu.reactions import is_cause_gone
from isa_ros.reu.wiring import Device, first_mode, IMPEDES, possible_modes, Reu
import numpy as np


ALWAYS, AUTO_ENABLE = '', 'auto_enable'
CAUSE_GONE, POSSIBLE = 'its cause is gone', 'it is possible'


class Transition(NamedTuple):
    """One row of the table of states."""

    state: int
    event: int
    guard: str
    """A condition besides the event; '': none."""
    following: int
    does: str
    """Effect on the actuator."""


TRANSITIONS = (
    Transition(INITIALISING, READY, AUTO_ENABLE, ENABLED, 'holds the position measured at t = 0'),
    Transition(INITIALISING, READY, f'not {AUTO_ENABLE}', DISABLED, 'valve stays at null'),
    Transition(INITIALISING, TRIP, ALWAYS, FAULT, 'valve stays at null'),
    Transition(INITIALISING, MODE, POSSIBLE, INITIALISING, 'mode of the next enable'),
    Transition(DISABLED, ENABLE, ALWAYS, ENABLED,
               'holds the last measured position, or takes the setpoint of the same command'),
    Transition(DISABLED, TRIP, ALWAYS, FAULT, 'valve stays at null'),
    Transition(DISABLED, MODE, POSSIBLE, DISABLED, 'mode of the next enable'),
    Transition(ENABLED, DISABLE, ALWAYS, DISABLED, 'valve to null, integrals zero'),
    Transition(ENABLED, STOP, ALWAYS, QUICK_STOP, 'the position block stops the movement'),
    Transition(ENABLED, TRIP, ALWAYS, FAULT_REACTION, 'the reaction of the condition begins'),
    Transition(ENABLED, MODE, POSSIBLE, ENABLED, 'the blocks of the mode take over, bumpless'),
    Transition(QUICK_STOP, STOP_ENDS, ALWAYS, DISABLED, 'valve to null, integrals zero'),
    Transition(QUICK_STOP, DISABLE, ALWAYS, DISABLED, 'valve to null at once'),
    Transition(QUICK_STOP, TRIP, ALWAYS, FAULT_REACTION, 'the reaction of the condition begins'),
    Transition(QUICK_STOP, MODE, POSSIBLE, QUICK_STOP, 'mode of the next enable'),
    Transition(FAULT_REACTION, REACTION_ENDS, ALWAYS, FAULT, 'valve to null, integrals zero'),
    Transition(FAULT_REACTION, DISABLE, ALWAYS, FAULT, 'valve to null at once'),
    Transition(FAULT_REACTION, MODE, POSSIBLE, FAULT_REACTION, 'mode of the next enable'),
    Transition(FAULT, CLEAR, CAUSE_GONE, DISABLED, 'the fault is forgotten'),
    Transition(FAULT, MODE, POSSIBLE, FAULT, 'mode of the next enable'),
)
"""Every transition; an event without a row for a state is ignored there."""

_GUARDS = (False, True)  # a guard of a row holds or not: two places of the kernel's table
_IGNORED = -1

DEVICE = np.dtype([
    ('next', 'i8', (len(STATES) * len(EVENTS) * len(_GUARDS),)),
    ('modes', 'i8'),               # bits 1 << mode of those that the wiring has
    ('stop_mode', 'i8'),           # mode of the stopping movement; 0: no position block
    ('initialisation', 'f8'),      # s
    ('ramps', 'f8'),               # 1: a quick stop brakes; 0: it holds at once
    ('deceleration', 'f8'),        # m/s2 | rad/s2
    ('hold', 'f8'),                # s
    ('period', 'f8'),              # between two steps of the device, s
    ('fade', 'f8')])               # share of a faded jump that is left after a period
DEVICE_STATE = np.dtype([
    ('state', 'i8'), ('mode', 'i8'), ('event', 'i8'),
    ('since_step', 'i8'),          # plant step of the last change of state, mode or conditions
    ('acting', 'i8'),              # the mode whose blocks run; another one during a stop
    ('is_on', 'i8'),               # 1: the blocks command the valve; 0: null
    ('is_stopping', 'i8'),         # 1: the position block follows ``stop``
    ('auto_enable', 'i8'),
    ('requests', 'i8'),            # kinds of the commands since the last step
    ('requested_mode', 'i8'), ('requested_enable', 'i8'),
    ('refused', 'i8'),             # kinds of the commands that it refused in this tick
    ('refused_requests', 'i8'),    # to enable, clear or stop, since t = 0
    ('unused_setpoints', 'i8'),    # that came while it did not follow them
    ('trips', 'i8'), ('warnings', 'i8'),   # bits of the conditions at the last step
    ('stop_steps', 'f8'),          # periods until the stop ends
    ('stop', SETPOINT),            # of the stopping movement; its gains are those of the start
    ('fade', FADE)])


def next_states() -> np.ndarray:
    """Return `TRANSITIONS` as numbers: the next state by state, event and guard; -1: ignored."""
    table = np.full((len(STATES), len(EVENTS), len(_GUARDS)), _IGNORED)
    for row in TRANSITIONS:
        for guard in _GUARDS:
            if row.guard == ALWAYS or row.guard.startswith('not ') != guard:
                table[row.state, row.event, int(guard)] = row.following
    return table.reshape(-1)


def device_record(sheet: Device, reu: Reu, period: float) -> np.record:
    """Return the `DEVICE` record of an REU whose current block has a period in s."""
    first = first_mode(reu)
    return record(
        DEVICE, next=next_states(), modes=sum(1 << mode for mode in possible_modes(reu)),
        stop_mode=first if first > FORCE else NO_MODE,
        initialisation=sheet.initialisation_ms * 1e-3, ramps=float(sheet.quick_stop == 'ramp'),
        deceleration=sheet.quick_stop_deceleration, hold=sheet.quick_stop_hold_ms * 1e-3,
        period=period, fade=exp(-period / (sheet.fade_ms * 1e-3)))


@kernel
def hold_here(setpoint, position):
    """Set a setpoint at rest at a position, without effort or reference; the gains stay."""
    setpoint.position = position
    setpoint.velocity = 0.0
    setpoint.effort = 0.0
    setpoint.reference = 0.0
    setpoint.is_reference = 0.0


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
    if own.state == FAULT_REACTION and found.reaction == REACTS_BY_DISABLE:
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
        own.requested_mode = own.mode
    if own.requests & HAS_ENABLE:
        own.refused &= ~HAS_ENABLE
        happens(ENABLE if own.requested_enable else DISABLE, 0, step, reu, own)
        if own.requested_enable != is_enabled(own):
            refuse(HAS_ENABLE, own)
    if own.requests & HAS_QUICK_STOP and not happens(STOP, 0, step, reu, own):
        refuse(HAS_QUICK_STOP, own)
    if own.requests & (HAS_SETPOINT | HAS_REFERENCE) and (
            not is_enabled(own) or state.protection.reaction >= REACTS_BY_HOLD):
        own.unused_setpoints += 1


@kernel
def stops(device_state):
    """Return whether a state stops the movement."""
    return device_state == QUICK_STOP or device_state == FAULT_REACTION


@kernel
def begin_stop(reference, reu, state):
    """
    Begin to stop; ``reference`` is the force (N | Nm) with which the position block takes over.

    An impedance keeps the effort of the setpoint, which bears the load; without one the force.
    """
    own, setup = state.status, reu.rules
    hold_here(own.stop, state.measured.position)
    if reu.position_kind == IMPEDES:
        own.stop.effort = state.setpoint.effort if own.acting >= FORCE else reference
    if setup.ramps > 0.0:
        own.stop.velocity = state.speed.velocity
        own.stop_steps += abs(own.stop.velocity) / (setup.deceleration * setup.period)


@kernel
def stop_is_over(reu, state):
    """Advance a stop by a period; return whether its reference was at rest long enough."""
    own, setup = state.status, reu.rules
    before = own.stop.velocity
    change = setup.deceleration * setup.period
    own.stop.velocity = max(0.0, before - change) if before > 0.0 else min(0.0, before + change)
    own.stop.position += 0.5 * (before + own.stop.velocity) * setup.period
    own.stop_steps -= 1.0
    return own.stop_steps <= 0.0


@kernel
def let_act(entered, reu, state):
    """Let the blocks of the state and mode act, bumpless; ``entered`` is the state before."""
    own, setup = state.status, reu.rules
    is_stop = stops(own.state)
    begins_stop = is_stop and not stops(entered)
    acting = setup.stop_mode if is_stop else own.mode
    was_on = own.is_on
    own.is_on = int(own.state == ENABLED or is_stop and setup.stop_mode > 0)
    own.is_stopping = int(is_stop and setup.stop_mode > 0)
    if begins_stop:
        own.stop_steps = setup.hold / setup.period
    if was_on and own.is_on and (begins_stop or acting != own.acting):
        reference = take_over(own.acting, acting, reu, state)
        own.fade.begins = 1
        if begins_stop:
            begin_stop(reference, reu, state)
        elif not own.requests & (HAS_SETPOINT | HAS_REFERENCE):
            start_setpoint(acting, reference, state)
    if not own.is_on:
        own.fade.begins = own.fade.is_on = 0
    own.acting = acting


@kernel
def device_step(step, reu, state):
    """Run the device at one conversion, before the blocks."""
    own, found = state.status, state.protection
    if (own.state == ENABLED and own.requests == 0 and own.warnings == found.warnings
            and own.trips == found.trips and found.reaction < REACTS_BY_QUICK_STOP):
        return
    entered = own.state
    if entered == INITIALISING and step * PLANT_STEP >= reu.rules.initialisation:
        happens(READY, own.auto_enable, step, reu, own)
    take_conditions(step, reu, state)
    if own.requests:
        take_requests(step, reu, state)
    if stops(entered) and stops(own.state) and stop_is_over(reu, state):
        happens(STOP_ENDS if own.state == QUICK_STOP else REACTION_ENDS, 0, step, reu, own)
    let_act(entered, reu, state)
    own.requests = 0


@kernel
def write_device(own, sample):
    """Write state, mode, event, since when (s), and counts of a run into a `SAMPLE`."""
    sample.device_state, sample.device_mode = own.state, own.mode
    sample.device_event = own.event
    sample.state_since = own.since_step * PLANT_STEP
    sample.unused_setpoints = float(own.unused_setpoints)
    sample.refused_requests = float(own.refused_requests)
