"""Mode at the start, and answers to requests: what a device accepts in its state."""

from isa_ros.core.conditions import BITS, conditions
from isa_ros.core.device import (
    CLEAR, DISABLE, DISABLED, ENABLE, ENABLED, FAULT, INITIALISING, QUICK_STOP, state_name, STOP)
from isa_ros.core.signals import COMMAND, HAS_CLEAR_FAULT, HAS_ENABLE, HAS_MODE, HAS_QUICK_STOP
from isa_ros.core.units import MPA
from isa_ros.reu.device import is_held
from isa_ros.reu.protection import GONE, HOLD
from isa_ros.reu.reactions import is_cause_gone
from isa_ros.reu.transitions import TRANSITIONS
from isa_ros.reu.wiring import first_mode, mode_of, Reu
import numpy as np

_STAYS = {ENABLE: ENABLED, DISABLE: DISABLED}
"""The state in which an event changes nothing, and is right to do so."""


def start_mode(name: str, mode: str | None, reu: Reu) -> int:
    """
    Return the mode in which an actuator starts, a number of `isa_ros.core.device`.

    Raises
    ------
    ConfigError
        The wiring does not have the configured mode.

    """
    return first_mode(reu) if mode is None else mode_of(mode, reu, f'{name}: mode')


def mode_command(mode: str, reu: Reu) -> np.void:
    """Return the `COMMAND` row that changes the mode; raises as `mode_of`."""
    command: np.void = np.zeros(1, COMMAND)[0]
    command['kinds'], command['mode'] = HAS_MODE, mode_of(mode, reu)
    return command


def mode_after(pending: np.record, reu: np.record) -> int:
    """Return the mode after the ``pending`` `COMMAND` has taken effect on a `REU_STATE`."""
    own = pending.mode if int(pending.kinds) & HAS_MODE else reu.status.requested_mode
    return int(own)


def link_answer(t_ns: int, observed: np.record) -> tuple[bool, str]:
    """
    Return what a request handed to a link is answered: whether it may arrive, and why.

    ``observed`` is the `SAMPLE` that has arrived; whether the device takes the request shows
    in a later one.
    """
    if observed.is_stale:
        return False, (f'the link is lost: the last sample is {observed.age:.6f} s old; handed to '
                       'the link, and dropped if no frame leaves in time')
    return True, (f'handed to the link at t = {t_ns * 1e-9:.6f} s, its last sample is '
                  f'{observed.age:.6f} s old')


def _frozen(reu: np.record) -> str:
    return f'no answer for {reu.frozen_for:.6f} s: the program of the REU has stopped'


def _state_after(pending: np.record, constants: np.record, reu: np.record) -> int:
    """Return the state after the ``pending`` `COMMAND` has enabled, disabled or cleared it."""
    kinds, state = int(pending.kinds), int(reu.status.state)
    if state == INITIALISING and constants.rules.initialisation == 0.0:
        state = ENABLED if reu.status.auto_enable else DISABLED
    if kinds & HAS_CLEAR_FAULT and state == FAULT and is_cause_gone(constants.protection, reu):
        state = DISABLED
    if kinds & HAS_ENABLE and state in (DISABLED, ENABLED):
        state = ENABLED if pending.is_enabled else DISABLED
    return state


def deafness_of(pending: np.record, constants: np.record, reu: np.record) -> str:
    """Return why a device would not follow a setpoint at the next tick, or ''."""
    if constants.is_frozen:
        return _frozen(reu)
    state, kinds = _state_after(pending, constants, reu), int(pending.kinds)
    if state == INITIALISING and (
            pending.is_enabled if kinds & HAS_ENABLE else reu.status.auto_enable):
        state = ENABLED
    if kinds & HAS_ENABLE and pending.is_enabled and state == QUICK_STOP and is_held(
            constants.rules, reu.status):
        state = ENABLED
    if kinds & HAS_QUICK_STOP and state == ENABLED:
        state = QUICK_STOP
    if state != ENABLED:
        return f'the state is {state_name(state)}'
    trips = conditions(int(reu.protection.trips)) if reu.status.state == ENABLED else []
    holding = [name for name in trips if name != 'setpoint_timeout'     # which a setpoint ends
               and constants.protection.reaction[BITS[name]] >= HOLD]
    return f'tripped: {", ".join(holding)}' if holding else ''


def refusal_of(
        command: np.void, pending: np.record, constants: np.record, reu: np.record) -> str:
    """Return why a request of enable, clear or stop would change nothing, or ''."""
    if constants.is_frozen:
        return _frozen(reu)
    kinds, state = int(command['kinds']), _state_after(pending, constants, reu)
    is_gone = is_cause_gone(constants.protection, reu)
    for kind, event, what in (
            (HAS_ENABLE, ENABLE if command['is_enabled'] else DISABLE, 'enable'),
            (HAS_CLEAR_FAULT, CLEAR, 'clear_fault'), (HAS_QUICK_STOP, STOP, 'quick_stop')):
        if not kinds & kind or _STAYS.get(event) == state:
            continue
        if not any(row.state == state and row.event == event for row in TRANSITIONS):
            states = [state_name(row.state) for row in TRANSITIONS if row.event == event]
            return f'the state is {state_name(state)}, {what} needs {" or ".join(states)}'
        if event == CLEAR and not is_gone:
            return 'the cause of the fault is not gone'
        if event == ENABLE and constants.rules.emergency_stop > 0.0:
            return 'the emergency stop is not released'
        if event == ENABLE and reu.protection.supply_taken == GONE:
            return (f'the supply pressure is {reu.supply_pressure / MPA:.2f} MPa: what the '
                    'emergency stop took is not back')
        if event == ENABLE and state == QUICK_STOP and not is_held(constants.rules, reu.status):
            return 'the quick stop has not ended'
    return ''
