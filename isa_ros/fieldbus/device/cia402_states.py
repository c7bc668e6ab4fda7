"""
States of a CiA 402 drive and what changes them, as data.

The numbers are those of the profile. One transition happens in a tick, so that a master sees each
state; only what the REU reports by itself (a fault, the end of a stop) may add another one.
"""

from enum import Enum
from typing import NamedTuple

from isa_ros.fieldbus.device.states import DeviceState, following, Transition

FAULT_RESET = 1 << 7
"""Bit of the controlword whose rising edge resets a fault."""


class State402(DeviceState):
    """States by name and status word; `STATE_MASK` are the bits that tell."""

    NOT_READY = ('not ready to switch on', 0x00)
    SWITCH_ON_DISABLED = ('switch on disabled', 0x40)
    READY = ('ready to switch on', 0x21)
    SWITCHED_ON = ('switched on', 0x23)
    OPERATION_ENABLED = ('operation enabled', 0x27)
    QUICK_STOP = ('quick stop active', 0x07)
    FAULT_REACTION = ('fault reaction active', 0x0F)
    FAULT = ('fault', 0x08)


STATE_MASK = 0x6F


class Event402(Enum):
    """What may change the state: commands of the control word, and what the REU reports."""

    INITIALISED = 'the first sample'
    SHUTDOWN = 'shutdown'
    SWITCH_ON = 'switch on, or disable operation'
    ENABLE = 'enable operation'
    DISABLE_VOLTAGE = 'disable voltage'
    STOP = 'quick stop'
    LEFT = 'the bus leaves operational'
    LOCAL_STOP = 'a quick stop from elsewhere'
    DROPPED = 'disabled from elsewhere'
    EMERGENCY_STOP = 'the emergency stop'
    STOPPED = 'the REU is disabled'
    FAULT = 'a fault'
    REACTION_ENDS = "the REU's outputs are off"
    RESET = 'fault reset'


class ControlPattern(NamedTuple):
    """A pattern of the control word."""

    mask: int
    value: int
    event: Event402


COMMANDS = (
    ControlPattern(0x87, 0x06, Event402.SHUTDOWN), ControlPattern(0x8F, 0x07, Event402.SWITCH_ON),
    ControlPattern(0x8F, 0x0F, Event402.ENABLE),
    ControlPattern(0x82, 0x00, Event402.DISABLE_VOLTAGE),
    ControlPattern(0x86, 0x02, Event402.STOP))
"""Every pattern; a word that fits none changes nothing."""

REU_DISABLED, ENDS_OFF, STAYS, CAUSE_GONE, RELEASED = (
    'the REU is disabled',
    'option code 0 or 2, the bus has left operational, or an emergency stop',
    'option code 6, the bus has stayed, and the REU has stopped',
    'its cause is gone', 'no emergency stop is open')


_SHOWN, _OFF = 'nothing', 'the REU is disabled: valve to null'
_OFF_BY_CODE = f'{_OFF}; with option code 1 its quick stop first'
_NO_FAULT = tuple(
    one for one in State402 if one not in (State402.FAULT_REACTION, State402.FAULT))

TRANSITIONS = (
    Transition(1, State402.NOT_READY, Event402.INITIALISED, '', State402.SWITCH_ON_DISABLED,
               _SHOWN),
    Transition(2, State402.SWITCH_ON_DISABLED, Event402.SHUTDOWN, RELEASED, State402.READY,
               _SHOWN),
    Transition(3, State402.READY, Event402.SWITCH_ON, '', State402.SWITCHED_ON, _SHOWN),
    Transition(3, State402.READY, Event402.ENABLE, '', State402.SWITCHED_ON, 'then transition 4'),
    Transition(4, State402.SWITCHED_ON, Event402.ENABLE, REU_DISABLED, State402.OPERATION_ENABLED,
               'the REU is enabled in the mode of operation'),
    Transition(5, State402.OPERATION_ENABLED, Event402.SWITCH_ON, '', State402.SWITCHED_ON,
               _OFF_BY_CODE),
    Transition(6, State402.SWITCHED_ON, Event402.SHUTDOWN, '', State402.READY, _SHOWN),
    Transition(7, State402.READY, Event402.DISABLE_VOLTAGE, '', State402.SWITCH_ON_DISABLED,
               _SHOWN),
    Transition(7, State402.READY, Event402.STOP, '', State402.SWITCH_ON_DISABLED, _SHOWN),
    Transition(7, State402.READY, Event402.LEFT, '', State402.SWITCH_ON_DISABLED, _SHOWN),
    Transition(7, State402.READY, Event402.EMERGENCY_STOP, '', State402.SWITCH_ON_DISABLED,
               _SHOWN),
    Transition(8, State402.OPERATION_ENABLED, Event402.SHUTDOWN, '', State402.READY,
               _OFF_BY_CODE),
    Transition(9, State402.OPERATION_ENABLED, Event402.DISABLE_VOLTAGE, '',
               State402.SWITCH_ON_DISABLED, _OFF),
    Transition(9, State402.OPERATION_ENABLED, Event402.DROPPED, '', State402.SWITCH_ON_DISABLED,
               'it was `~/enable` with false, for example'),
    Transition(9, State402.OPERATION_ENABLED, Event402.EMERGENCY_STOP, REU_DISABLED,
               State402.SWITCH_ON_DISABLED, _SHOWN),
    Transition(10, State402.SWITCHED_ON, Event402.DISABLE_VOLTAGE, '', State402.SWITCH_ON_DISABLED,
               _SHOWN),
    Transition(10, State402.SWITCHED_ON, Event402.STOP, '', State402.SWITCH_ON_DISABLED, _SHOWN),
    Transition(10, State402.SWITCHED_ON, Event402.LEFT, '', State402.SWITCH_ON_DISABLED, _SHOWN),
    Transition(10, State402.SWITCHED_ON, Event402.EMERGENCY_STOP, '', State402.SWITCH_ON_DISABLED,
               _SHOWN),
    Transition(11, State402.OPERATION_ENABLED, Event402.STOP, '', State402.QUICK_STOP,
               'the quick stop of the REU; with option code 0 it is disabled'),
    Transition(11, State402.OPERATION_ENABLED, Event402.LOCAL_STOP, '', State402.QUICK_STOP,
               'it was `~/quick_stop` or the emergency stop'),
    Transition(11, State402.OPERATION_ENABLED, Event402.LEFT, '', State402.QUICK_STOP,
               'the same; it ends off, whatever the option code'),
    Transition(12, State402.QUICK_STOP, Event402.STOPPED, ENDS_OFF, State402.SWITCH_ON_DISABLED,
               _SHOWN),
    Transition(12, State402.QUICK_STOP, Event402.DISABLE_VOLTAGE, '', State402.SWITCH_ON_DISABLED,
               _OFF),
    *(Transition(13, state, Event402.FAULT, '', State402.FAULT_REACTION,
                 'the reaction of the condition; of the bus and of the following error a quick '
                 'stop, or by option code 0 off at once') for state in _NO_FAULT),
    Transition(14, State402.FAULT_REACTION, Event402.REACTION_ENDS, '', State402.FAULT, _SHOWN),
    Transition(15, State402.FAULT, Event402.RESET, CAUSE_GONE, State402.SWITCH_ON_DISABLED,
               'the fault is forgotten'),
    Transition(16, State402.QUICK_STOP, Event402.ENABLE, STAYS, State402.OPERATION_ENABLED,
               'the REU is enabled again'),
)
"""Every transition after power-on (0); an event without a row for a state is ignored there."""

FOLLOWING = following(TRANSITIONS)


def command_of(control: int) -> Event402 | None:
    """Return the command of a control word; None: it has none."""
    for mask, value, event in COMMANDS:
        if control & mask == value:
            return event
    return None
