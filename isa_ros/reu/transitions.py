"""
The table of the states of an actuator's device, and what a kernel reads of it.

The states follow CiA 402; `isa_ros.reu.device` lets the events happen.
"""

from typing import NamedTuple

from isa_ros.core.device import (
    CLEAR, DISABLE, DISABLED, EMERGENCY_STOP, ENABLE, ENABLED, EVENTS, FAULT, FAULT_REACTION,
    INITIALISING, MODE, QUICK_STOP, REACTION_ENDS, READY, STATES, STOP, STOP_ENDS, TRIP)
import numpy as np

ALWAYS, AUTO_ENABLE = '', 'auto_enable'
CAUSE_GONE, POSSIBLE = 'its cause is gone', 'it is possible'
AT_REST = 'at rest, quick_stop: ramp_and_hold'
RELEASED = 'no emergency stop, the supply is back'


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
    Transition(INITIALISING, READY, AUTO_ENABLE, ENABLED,
               'holds the measured position and force, or takes the setpoint of that tick'),
    Transition(INITIALISING, READY, f'not {AUTO_ENABLE}', DISABLED, 'valve stays at null'),
    Transition(INITIALISING, TRIP, ALWAYS, FAULT, 'valve stays at null'),
    Transition(INITIALISING, ENABLE, RELEASED, INITIALISING, 'will be enabled when it is ready'),
    Transition(INITIALISING, DISABLE, ALWAYS, INITIALISING, 'will be disabled when it is ready'),
    Transition(INITIALISING, STOP, ALWAYS, INITIALISING, 'will be disabled when it is ready'),
    Transition(INITIALISING, EMERGENCY_STOP, ALWAYS, INITIALISING,
               'will be disabled when it is ready'),
    Transition(INITIALISING, MODE, POSSIBLE, INITIALISING, 'mode of the next enable'),
    Transition(DISABLED, ENABLE, RELEASED, ENABLED,
               'holds the last measured position and force, or takes the setpoint of the same '
               'command'),
    Transition(DISABLED, TRIP, ALWAYS, FAULT, 'valve stays at null'),
    Transition(DISABLED, MODE, POSSIBLE, DISABLED, 'mode of the next enable'),
    Transition(ENABLED, DISABLE, ALWAYS, DISABLED, 'valve to null, integrals zero'),
    Transition(ENABLED, STOP, ALWAYS, QUICK_STOP, 'the movement stops, the load is borne'),
    Transition(ENABLED, EMERGENCY_STOP, ALWAYS, QUICK_STOP,
               'as quick stop, and ends disabled also with ramp_and_hold'),
    Transition(ENABLED, TRIP, ALWAYS, FAULT_REACTION, 'the reaction of the condition begins'),
    Transition(ENABLED, MODE, POSSIBLE, ENABLED, 'the blocks of the mode take over, bumpless'),
    Transition(QUICK_STOP, STOP_ENDS, ALWAYS, DISABLED, 'valve to null, integrals zero'),
    Transition(QUICK_STOP, ENABLE, AT_REST, ENABLED, 'as from disabled'),
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

GUARDS = (False, True)  # a guard of a row holds or not: two places of the kernel's table
_IGNORED = -1


def next_states() -> np.ndarray:
    """Return `TRANSITIONS` as numbers: the next state by state, event and guard; -1: ignored."""
    table = np.full((len(STATES), len(EVENTS), len(GUARDS)), _IGNORED)
    for row in TRANSITIONS:
        for guard in GUARDS:
            if row.guard == ALWAYS or row.guard.startswith('not ') != guard:
                table[row.state, row.event, int(guard)] = row.following
    return table.reshape(-1)
