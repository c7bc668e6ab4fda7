"""
States of a CiA 408 device (fluid power) and what changes them, as data.

The bits D, H and M of the control word name the state that is wanted; the device goes there one
transition a tick. The numbers are those of public manuals of valves with this profile.
"""

from enum import Enum

from isa_ros.fieldbus.device.states import DeviceState, following, Transition

D, H, M, R = 1, 2, 4, 8
"""Bits of control word and status word; R is the reset of a fault, and ready."""
STATE_MASK = D | H | M | R


class State408(DeviceState):
    """States by name, bits of the status word, and how far they are: see `level_of`."""

    NOT_READY = ('NOT READY', 0, 0)
    INIT = ('INIT', R, 0)
    DISABLED = ('DISABLED', R | D, 1)
    HOLD = ('HOLD', R | H | D, 2)
    ACTIVE = ('ACTIVE', R | M | H | D, 3)
    FAULT_INIT = ('FAULT_INIT', 0, 0)
    FAULT_DISABLED = ('FAULT_DISABLED', D, 1)
    FAULT_HOLD = ('FAULT_HOLD', H | D, 2)
    FAULT_REACTION = ('FAULT_REACTION', M | H | D, 3)


FAULTS = (State408.FAULT_INIT, State408.FAULT_DISABLED, State408.FAULT_HOLD)
"""States that a reset ends."""
HOLDING = (State408.HOLD, State408.ACTIVE, State408.FAULT_HOLD, State408.FAULT_REACTION)
"""States in which the outputs of the REU may be on."""


class Event408(Enum):
    """What may change the state."""

    INITIALISED = 'the first sample'
    RISE = 'the control word wants a higher state'
    FALL = 'the control word wants a lower state'
    FAULT = 'a fault'
    REACTION_ENDS = 'the reaction is over'
    RESET = 'R rises'
    LEFT = 'the bus leaves operational'
    DROPPED = 'disabled or stopped from elsewhere'


MAY_ENABLE, MAY_ACT, HOLDS, WAS_DISABLED, WAS_INIT, CAUSE_GONE = (
    'the REU is disabled', 'M has fallen since the bus left operational', 'the REU holds',
    'the REU is off, it was DISABLED or above',
    'the REU is off, it was INIT', 'its cause is gone')


_SHOWN, _OFF = 'nothing', 'the REU is disabled: valve to null'
_HOLDS = 'the REU is enabled in the control mode, with the hold setpoint'

TRANSITIONS = (
    Transition('1', State408.NOT_READY, Event408.INITIALISED, '', State408.INIT, _SHOWN),
    Transition('2', State408.INIT, Event408.RISE, '', State408.DISABLED, _SHOWN),
    Transition('3', State408.DISABLED, Event408.RISE, MAY_ENABLE, State408.HOLD, _HOLDS),
    Transition('4', State408.HOLD, Event408.RISE, MAY_ACT, State408.ACTIVE,
               'the setpoint of the bus'),
    Transition('5', State408.ACTIVE, Event408.FALL, '', State408.HOLD, 'the hold setpoint'),
    Transition('5', State408.ACTIVE, Event408.LEFT, '', State408.HOLD,
               'the hold setpoint; M must fall before it is active again'),
    Transition('6', State408.HOLD, Event408.FALL, '', State408.DISABLED, _OFF),
    Transition('7', State408.DISABLED, Event408.FALL, '', State408.INIT, _SHOWN),
    *(Transition('8', state, Event408.FAULT, '', State408.FAULT_REACTION,
                 'the reaction of the condition; of a lost bus the hold setpoint')
      for state in (State408.INIT, State408.DISABLED, State408.HOLD, State408.ACTIVE,
                    State408.FAULT_HOLD)),
    Transition('9', State408.FAULT_REACTION, Event408.REACTION_ENDS, HOLDS, State408.FAULT_HOLD,
               'the hold setpoint'),
    Transition('10', State408.FAULT_DISABLED, Event408.RESET, CAUSE_GONE, State408.DISABLED,
               'the fault is forgotten'),
    Transition('11', State408.FAULT_HOLD, Event408.RESET, CAUSE_GONE, State408.HOLD,
               'the fault is forgotten'),
    Transition('12', State408.FAULT_REACTION, Event408.REACTION_ENDS, WAS_DISABLED,
               State408.FAULT_DISABLED, _SHOWN),
    Transition('13', State408.FAULT_REACTION, Event408.REACTION_ENDS, WAS_INIT,
               State408.FAULT_INIT, _SHOWN),
    Transition('14', State408.FAULT_INIT, Event408.RESET, CAUSE_GONE, State408.INIT,
               'the fault is forgotten'),
    Transition('15', State408.FAULT_HOLD, Event408.FALL, '', State408.FAULT_DISABLED, _OFF),
    Transition('16', State408.FAULT_DISABLED, Event408.FALL, '', State408.FAULT_INIT, _SHOWN),
    *(Transition('', state, Event408.DROPPED, '', State408.DISABLED,
                 'H must fall before it is enabled again')
      for state in (State408.HOLD, State408.ACTIVE)),
)
"""Every transition after power-on (0); an event without a row for a state is ignored there."""

FOLLOWING = following(TRANSITIONS)


def level_of(control: int) -> int:
    """Return the state that a control word wants: 0 INIT, 1 DISABLED, 2 HOLD, 3 ACTIVE."""
    for level, bit in enumerate((D, H, M)):
        if not control & bit:
            return level
    return State408.ACTIVE.level


def control_of(level: int) -> int:
    """Return a control word that wants a state."""
    return (1 << level) - 1
