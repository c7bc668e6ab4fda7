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


class DeviceTransition(NamedTuple):
    """One row of the table of states."""

    state: int
    event: int
    guard: str
    """A condition besides the event; '': none."""
    following: int
    does: str
    """Effect on the actuator."""


TRANSITIONS = (
    DeviceTransition(INITIALISING, READY, AUTO_ENABLE, ENABLED,
                     'holds the measured position and force, or takes the setpoint of that tick'),
    DeviceTransition(INITIALISING, READY, f'not {AUTO_ENABLE}', DISABLED, 'valve stays at null'),
    DeviceTransition(INITIALISING, TRIP, ALWAYS, FAULT, 'valve stays at null'),
    DeviceTransition(INITIALISING, ENABLE, RELEASED, INITIALISING,
                     'will be enabled when it is ready'),
    DeviceTransition(INITIALISING, DISABLE, ALWAYS, INITIALISING,
                     'will be disabled when it is ready'),
    DeviceTransition(INITIALISING, STOP, ALWAYS, INITIALISING,
                     'will be disabled when it is ready'),
    DeviceTransition(INITIALISING, EMERGENCY_STOP, ALWAYS, INITIALISING,
                     'will be disabled when it is ready'),
    DeviceTransition(INITIALISING, MODE, POSSIBLE, INITIALISING, 'mode of the next enable'),
    DeviceTransition(DISABLED, ENABLE, RELEASED, ENABLED,
                     'holds the last measured position and force, or takes the setpoint of the '
                     'same command'),
    DeviceTransition(DISABLED, TRIP, ALWAYS, FAULT, 'valve stays at null'),
    DeviceTransition(DISABLED, MODE, POSSIBLE, DISABLED, 'mode of the next enable'),
    DeviceTransition(ENABLED, DISABLE, ALWAYS, DISABLED, 'valve to null, integrals zero'),
    DeviceTransition(ENABLED, STOP, ALWAYS, QUICK_STOP, 'the movement stops, the load is borne'),
    DeviceTransition(ENABLED, EMERGENCY_STOP, ALWAYS, QUICK_STOP,
                     'as quick stop, and ends disabled also with ramp_and_hold'),
    DeviceTransition(ENABLED, TRIP, ALWAYS, FAULT_REACTION,
                     'the reaction of the condition begins'),
    DeviceTransition(ENABLED, MODE, POSSIBLE, ENABLED,
                     'the blocks of the mode take over, bumpless'),
    DeviceTransition(QUICK_STOP, STOP_ENDS, ALWAYS, DISABLED, 'valve to null, integrals zero'),
    DeviceTransition(QUICK_STOP, ENABLE, AT_REST, ENABLED, 'as from disabled'),
    DeviceTransition(QUICK_STOP, DISABLE, ALWAYS, DISABLED, 'valve to null at once'),
    DeviceTransition(QUICK_STOP, TRIP, ALWAYS, FAULT_REACTION,
                     'the reaction of the condition begins'),
    DeviceTransition(QUICK_STOP, MODE, POSSIBLE, QUICK_STOP, 'mode of the next enable'),
    DeviceTransition(FAULT_REACTION, REACTION_ENDS, ALWAYS, FAULT,
                     'valve to null, integrals zero'),
    DeviceTransition(FAULT_REACTION, DISABLE, ALWAYS, FAULT, 'valve to null at once'),
    DeviceTransition(FAULT_REACTION, MODE, POSSIBLE, FAULT_REACTION, 'mode of the next enable'),
    DeviceTransition(FAULT, CLEAR, CAUSE_GONE, DISABLED, 'the fault is forgotten'),
    DeviceTransition(FAULT, MODE, POSSIBLE, FAULT, 'mode of the next enable'),
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
