"""States of the device: the table, and what the kernel makes of any sequence of events."""

import random

from isa_ros.core.device import (
    DISABLED, ENABLED, FAULT, FAULT_REACTION, IMPEDANCE, INITIALISING, QUICK_STOP)
from isa_ros.core.signals import HAS_CLEAR_FAULT, HAS_ENABLE, HAS_MODE, HAS_QUICK_STOP
from isa_ros.reu import device, transitions
import pytest
from tests.reu.devices import (
    BIT, constants, DISABLES, find, PERIOD, QUICK_STOPS, request, starting, STOP_STEPS)
from tests.reu.states import enabled_state
from tests.sheets import MODELS


class Expected:
    """The device in plain words, written without its table."""

    def __init__(self):
        self.state, self.mode, self.left = INITIALISING, IMPEDANCE, 0

    def step(self, kinds, enable, mode, reaction, is_gone):
        """Take one conversion's requests and findings."""
        trips = reaction >= QUICK_STOPS
        was = self.state
        if self.state == INITIALISING:
            self.state = ENABLED
        if trips and self.state in (ENABLED, QUICK_STOP):
            self.state = FAULT_REACTION
            if was != QUICK_STOP:
                self.left = STOP_STEPS
        elif trips and self.state in (INITIALISING, DISABLED):
            self.state = FAULT
        if reaction == DISABLES and self.state == FAULT_REACTION:
            self.state = FAULT
        if kinds & HAS_CLEAR_FAULT and self.state == FAULT and is_gone:
            self.state = DISABLED
        if kinds & HAS_MODE and mode in (1, 2, 4, 6):
            self.mode = mode
        if kinds & HAS_ENABLE:
            if enable and self.state == DISABLED:
                self.state = ENABLED
            elif not enable and self.state in (ENABLED, QUICK_STOP):
                self.state = DISABLED
            elif not enable and self.state == FAULT_REACTION:
                self.state = FAULT
        if kinds & HAS_QUICK_STOP and self.state == ENABLED:
            self.state, self.left = QUICK_STOP, STOP_STEPS
        stopping = (QUICK_STOP, FAULT_REACTION)
        if was in stopping and self.state in stopping:
            self.left -= 1
            if self.left <= 0:
                self.state = DISABLED if self.state == QUICK_STOP else FAULT


def random_events(dice):
    """Return kinds, enable, mode and reaction of one conversion; mostly nothing."""
    kinds = sum(kind for kind in (HAS_ENABLE, HAS_MODE, HAS_CLEAR_FAULT, HAS_QUICK_STOP)
                if dice.random() < 0.01)
    reaction = dice.choice((1, 2, 5, 6)) if dice.random() < 0.004 else 0
    return kinds, dice.randrange(2), dice.randrange(1, 7), reaction


@pytest.mark.parametrize('seed', range(3))
def test_any_sequence_of_events_leads_through_the_states_of_an_independent_device(seed):
    """20,000 conversions; every state is visited, the outputs follow from state and stop."""
    dice, reu, state, expected = random.Random(seed), constants(), starting(), Expected()
    visited, until, lasting = set(), 0, 0
    for k in range(20_000):
        kinds, enable, mode, reaction = random_events(dice)
        if k >= until:
            lasting = reaction
            until = k + dice.randrange(1, 300) if reaction else k
        find(state, lasting)
        request(state, kinds, enable, mode)
        device.device_step(k * PERIOD, reu, state)
        expected.step(kinds, enable, mode, int(state.protection.reaction), lasting < QUICK_STOPS)
        own = state.status
        assert (own.state, own.mode) == (expected.state, expected.mode), k
        assert bool(own.is_on) == (own.state in (ENABLED, QUICK_STOP, FAULT_REACTION))
        assert bool(own.is_stopping) == (own.state in (QUICK_STOP, FAULT_REACTION))
        assert own.requests == 0 and own.requested_mode == own.mode
        assert bool(own.trips) >= (own.state in (FAULT, FAULT_REACTION))
        visited.add(int(own.state))
    assert visited == {DISABLED, ENABLED, QUICK_STOP, FAULT_REACTION, FAULT}


def test_compiled_device_equals_its_python_source():
    """The same events, byte for byte."""
    reu, ends = constants(), []
    for step in (device.device_step, device.device_step.py_func):
        dice, state = random.Random(5), starting()
        for k in range(1500):
            kinds, enable, mode, reaction = random_events(dice)
            find(state, reaction)
            request(state, kinds, enable, mode)
            step(k * PERIOD, reu, state)
        ends.append(state.tobytes())
    assert ends[0] == ends[1]


def test_every_row_of_the_table_happens_once_for_its_state_event_and_guard():
    """No two rows contradict each other."""
    found = [(row.state, row.event, row.guard) for row in transitions.TRANSITIONS]
    assert len(set(found)) == len(found)
    table = transitions.next_states()
    assert (table >= 0).sum() == sum(2 if row.guard == transitions.ALWAYS else 1
                                     for row in transitions.TRANSITIONS)


def test_it_initialises_for_its_time_and_is_enabled_only_if_configured():
    reu = constants(initialisation_ms=2.0)
    for auto_enable, after in ((1, ENABLED), (0, DISABLED)):
        state = starting(auto_enable)
        for k in range(25):
            device.device_step(k * PERIOD, reu, state)
            assert state.status.state == (INITIALISING if k < 20 else after), k


@pytest.mark.parametrize('reaction, reached', [
    (1, ENABLED), (2, ENABLED), (3, ENABLED), (4, ENABLED), (5, FAULT_REACTION), (6, FAULT)])
def test_only_a_reaction_that_stops_changes_the_state(reaction, reached):
    reu, state = constants(), enabled_state(constants())
    find(state, reaction)
    device.device_step(0, reu, state)
    assert state.status.state == reached


def test_a_fault_is_kept_until_it_is_cleared_and_its_cause_is_gone():
    reu, state = constants(), enabled_state(constants())
    find(state, DISABLES)
    device.device_step(0, reu, state)
    request(state, HAS_CLEAR_FAULT)
    find(state, DISABLES)
    device.device_step(5, reu, state)
    assert (state.status.state, state.status.trips) == (FAULT, BIT)
    find(state, 0)
    request(state, HAS_ENABLE, enable=1)
    device.device_step(15, reu, state)
    assert (state.status.state, state.status.trips) == (FAULT, BIT)
    request(state, HAS_CLEAR_FAULT | HAS_ENABLE, enable=1)
    device.device_step(20, reu, state)
    assert state.status.state == ENABLED
    find(state, 0)
    device.device_step(25, reu, state)
    assert (state.status.state, state.status.trips) == (ENABLED, 0)


@pytest.mark.parametrize('kinds, enable, reached', [
    (HAS_ENABLE, 0, DISABLED), (HAS_QUICK_STOP, 0, DISABLED), (HAS_ENABLE, 1, ENABLED)])
def test_what_is_requested_while_it_initialises_is_in_force_when_it_is_ready(
        kinds, enable, reached):
    """10 ms of initialisation are 100 conversions; the opposite is configured."""
    reu, state = constants(initialisation_ms=10.0), starting(auto_enable=1 - enable)
    request(state, kinds, enable=enable)
    for k in range(101):
        assert state.status.state == INITIALISING
        device.device_step(k * PERIOD, reu, state)
    assert state.status.state == reached


def test_of_requests_while_it_initialises_the_last_counts():
    reu, state = constants(initialisation_ms=10.0), starting(auto_enable=1)
    for k in range(101):
        if k in (10, 20):
            request(state, HAS_ENABLE if k == 20 else HAS_QUICK_STOP, enable=1)
        device.device_step(k * PERIOD, reu, state)
    assert state.status.state == ENABLED


@pytest.mark.parametrize('model', MODELS)
def test_a_mode_that_the_wiring_does_not_have_is_ignored(model):
    """Refused where it comes from; were it not, the device keeps its mode."""
    reu = constants(model)
    state = enabled_state(reu)
    request(state, HAS_MODE, mode=5)    # position: the block is an impedance
    device.device_step(0, reu, state)
    assert (state.status.mode, state.status.requested_mode) == (IMPEDANCE, IMPEDANCE)
