"""States of the device: the table, and what the kernel makes of any sequence of events."""

import random

from isa_ros.actuator.sheet import actuator_record
from isa_ros.core.device import (
    CURRENT, DISABLED, ENABLED, FAULT, FAULT_REACTION, IMPEDANCE, INITIALISING, QUICK_STOP)
from isa_ros.core.signals import HAS_CLEAR_FAULT, HAS_ENABLE, HAS_MODE, HAS_QUICK_STOP
from isa_ros.reu import device, transitions
from isa_ros.reu.cascade import REU_STATE
import numpy as np
import pytest
from tests.reu.states import enabled_state
from tests.sheets import actuator_sheet, MODELS, override

PERIOD = 5          # plant steps between two conversions
STOP_STEPS = 2000   # conversions: 200 ms, the shipped time at rest
BIT = 1 << 3        # of any condition that disables
QUICK_STOPS, DISABLES = 5, 6    # places of these reactions


def constants(model='isa_v5', **values):
    """Return the REU's constants, with some parameters of the device replaced."""
    sheet = actuator_sheet(model)
    for name, value in values.items():
        sheet = override(sheet, f'reu.device.{name}', value)
    reu = actuator_record(sheet, 0).view(np.recarray)[0].reu
    reu.protection.reaction[:] = DISABLES
    return reu


def starting(auto_enable=1):
    """Return the state at t = 0."""
    state = np.zeros(1, REU_STATE).view(np.recarray)[0]
    own = state.status
    own.auto_enable = own.requested_enable = auto_enable
    own.mode = own.acting = own.requested_mode = IMPEDANCE
    return state


def request(state, kinds, enable=0, mode=0):
    """Let commands have taken effect at the tick's start."""
    own = state.status
    own.requests |= kinds
    if kinds & HAS_ENABLE:
        own.requested_enable = enable
    if kinds & HAS_MODE:
        own.requested_mode = mode


def find(state, reaction, bits=BIT):
    """Let the protection have found something; a trip that stops stays until it is cleared."""
    own = state.protection
    stops = reaction >= QUICK_STOPS
    own.present = bits if stops else 0
    latched = 0 if own.reaction < QUICK_STOPS or own.clears and not stops else own.reaction
    own.clears = 0
    own.reaction = max(reaction, latched)
    own.trips = bits if own.reaction else 0


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


@pytest.mark.parametrize('speed', [0.5, -0.5, 0.0])
def test_a_quick_stop_brakes_with_the_declared_deceleration(speed):
    """
    0.5 m/s at 10 m/s2, then 200 ms at rest.

    Below r the deceleration fades as the root of the speed: from there it takes 2 r/a and
    2 r^2/3a instead of r/a and r^2/2a.
    """
    reu, state = constants(), enabled_state(constants())
    state.speed.velocity, state.measured.position = speed, 0.05
    request(state, HAS_QUICK_STOP)
    device.device_step(0, reu, state)
    stop, n = state.status.stop, 0
    end = float(reu.rules.flow.rounding) if speed else 0.0
    assert (stop.velocity, stop.position) == (speed, 0.05)
    while state.status.state == QUICK_STOP:
        n += 1
        device.device_step(n * PERIOD, reu, state)
        if not state.status.flow.is_held:
            reached = float(stop.position)
        ramp = abs(speed) - 10.0 * n * 1e-4
        assert abs(stop.velocity) == pytest.approx(ramp, abs=1e-12) or ramp < end
    # a conversion each 0.1 ms; the last ones of a root of the speed end it earlier
    assert n == pytest.approx(1e3 * (abs(speed) + end) + STOP_STEPS, abs=5)
    assert abs(reached - 0.05) == pytest.approx(
        speed * speed / 20.0 + end * end / 60.0, abs=0.5e-4 * end)
    assert np.sign(reached - 0.05) == np.sign(speed)
    assert state.status.state == DISABLED


def test_a_load_that_never_stands_lets_a_stop_end_after_a_second():
    """It swings by 1 mm at 10 Hz; 1 s after the ramp, and its time at rest of 200 ms, it ends."""
    reu, state = constants(), enabled_state(constants())
    request(state, HAS_QUICK_STOP)
    for k in range(12_000):
        state.measured.position = 0.05 + 1e-3 * np.sin(2.0 * np.pi * 10.0 * k * 1e-4)
        device.device_step(k * PERIOD, reu, state)
        assert state.status.state == QUICK_STOP, k
    device.device_step(12_000 * PERIOD, reu, state)
    assert state.status.state == DISABLED


def test_the_time_at_rest_begins_anew_with_every_tenth_of_a_millimetre():
    """The position stands for 100 ms, moves on, and then for the 200 ms that are asked for."""
    reu, state = constants(), enabled_state(constants())
    request(state, HAS_QUICK_STOP)
    for k in range(1000 + STOP_STEPS):
        state.measured.position = 0.05 if k < 1000 else 0.05011
        device.device_step(k * PERIOD, reu, state)
        assert state.status.state == QUICK_STOP, k
    device.device_step((1000 + STOP_STEPS) * PERIOD, reu, state)
    assert state.status.state == DISABLED


def test_a_quick_stop_that_closes_has_the_valve_at_null_at_once_and_ends():
    reu, state = constants(quick_stop='close'), enabled_state(constants())
    state.speed.velocity, state.measured.position = 0.5, 0.05
    request(state, HAS_QUICK_STOP)
    device.device_step(0, reu, state)
    assert (state.status.state, state.status.is_on) == (QUICK_STOP, 0)
    device.device_step(5, reu, state)
    assert (state.status.state, state.status.is_on) == (DISABLED, 0)


def test_a_quick_stop_that_holds_stays_until_it_is_enabled_or_disabled():
    """Not before it is at rest, which 0.5 m/s at 10 m/s2 need 50 ms for."""
    for enable, reached in ((1, ENABLED), (0, DISABLED)):
        reu, state = constants(quick_stop='ramp_and_hold'), enabled_state(constants())
        state.speed.velocity, state.measured.position = 0.5, 0.05
        request(state, HAS_QUICK_STOP)
        for k in range(499):
            device.device_step(k * PERIOD, reu, state)
        request(state, HAS_ENABLE, enable=1)
        device.device_step(499 * PERIOD, reu, state)
        assert state.status.state == QUICK_STOP
        state.speed.velocity = 0.0
        for k in range(500, 5000):
            device.device_step(k * PERIOD, reu, state)
        assert (state.status.state, state.status.is_stopping) == (QUICK_STOP, 1)
        request(state, HAS_ENABLE, enable=enable)
        device.device_step(5000 * PERIOD, reu, state)
        assert (state.status.state, state.status.is_stopping) == (reached, 0)
        assert state.status.is_on == enable


def test_a_reaction_that_stops_ends_in_fault_also_where_a_quick_stop_holds():
    reu, state = constants(quick_stop='ramp_and_hold'), enabled_state(constants())
    find(state, QUICK_STOPS)
    for k in range(STOP_STEPS + 1):
        assert state.status.state == (FAULT_REACTION if k else ENABLED)
        device.device_step(k * PERIOD, reu, state)
    assert (state.status.state, state.status.is_on) == (FAULT, 0)


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


def test_without_a_position_block_a_quick_stop_ramps_the_flow_too():
    """The reference of the valve is that of the flow: at half the speed less than at all of it."""
    sheet = actuator_sheet('isa_v5', 'default', 'valve_amplifier')
    reu = actuator_record(sheet, 0).view(np.recarray)[0].reu
    state = enabled_state(reu)
    assert state.status.mode == CURRENT
    state.supply_pressure, state.measured.position = 20.7e6, 0.05
    state.speed.velocity = 0.2
    request(state, HAS_QUICK_STOP)
    device.device_step(0, reu, state)
    assert (state.status.state, state.status.is_on) == (QUICK_STOP, 1)
    first = float(state.status.stop.reference)
    for k in range(1, 101):
        device.device_step(k * PERIOD, reu, state)
    assert 0.0 < state.status.stop.reference < first
    for k in range(101, 350):   # 0.2 m/s need 20 ms, and 14 ms more for the gentle end
        device.device_step(k * PERIOD, reu, state)
    assert state.status.stop.reference == 0.0


@pytest.mark.parametrize('model', MODELS)
def test_a_mode_that_the_wiring_does_not_have_is_ignored(model):
    """Refused where it comes from; were it not, the device keeps its mode."""
    reu = constants(model)
    state = enabled_state(reu)
    request(state, HAS_MODE, mode=5)    # position: the block is an impedance
    device.device_step(0, reu, state)
    assert (state.status.mode, state.status.requested_mode) == (IMPEDANCE, IMPEDANCE)
