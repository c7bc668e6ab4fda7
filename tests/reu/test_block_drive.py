"""The current of the block valves: on before the outputs are on, off with them."""

from isa_ros.core.device import (
    DISABLED, EMERGENCY_STOP, ENABLED, FAULT, IMPEDANCE, INITIALISING, QUICK_STOP, STOP_ENDS)
from isa_ros.core.signals import HAS_CLEAR_FAULT, HAS_ENABLE, HAS_QUICK_STOP
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.reu.block_drive import LONG_AGO
from isa_ros.reu.bumpless import EVERY_BLOCK
from isa_ros.reu.device import device_step
from isa_ros.reu.protection import BLOCK, DISABLE, NONE
import pytest
from tests.reu.devices import constants, find, PERIOD, request, starting

OPENING = 0.03
NEVER = 10_000


class Driven:
    """A device with block valves that open in `OPENING`, at t = 0."""

    def __init__(self, auto_enable=1, when_off=1, **values):
        self.reu, self.state, self.step = constants(**values), starting(auto_enable), 0
        self.own, self.rules = self.state.status, self.reu.rules
        self.rules.opening, self.rules.closes_when_off = OPENING, when_off
        self.own.is_energised, self.own.switched = auto_enable or not when_off, LONG_AGO
        self.convert()

    def convert(self, conversions=1):
        for _ in range(conversions):
            device_step(self.step, self.reu, self.state)
            self.step += PERIOD

    def until(self, holds):
        """Return the time in s until something holds."""
        for k in range(NEVER):
            if holds():
                return k * PERIOD * PLANT_STEP
            self.convert()
        raise AssertionError('it never does')

    def ask(self, kinds, enable=0):
        request(self.state, kinds, enable)
        self.convert()

    @property
    def seen(self):
        return int(self.own.state), bool(self.own.is_on), bool(self.own.is_energised)


def test_a_run_that_begins_enabled_begins_with_open_valves():
    assert Driven().seen == (ENABLED, True, True)
    assert Driven(auto_enable=0).seen == (DISABLED, False, False)
    assert Driven(auto_enable=0, when_off=0).seen == (DISABLED, False, True)


def test_the_outputs_wait_for_the_valves_to_open_and_both_go_off_together():
    driven = Driven(auto_enable=0)
    driven.ask(HAS_ENABLE, 1)
    assert driven.seen == (ENABLED, False, True)
    assert driven.own.is_open == 0
    assert driven.until(lambda: driven.own.is_on) == pytest.approx(OPENING, abs=1.1e-4)
    assert driven.own.fade.begins == EVERY_BLOCK   # they take over without a jump
    assert driven.own.is_open == 1
    driven.ask(HAS_ENABLE, 0)
    assert driven.seen == (DISABLED, False, False) and driven.own.is_open == 0


def test_valves_without_current_are_not_open_however_long_ago_it_went_off():
    driven = Driven()
    driven.ask(HAS_ENABLE, 0)
    driven.convert(400)     # longer than they take to open
    assert driven.own.is_open == 0


def test_what_is_disabled_while_its_valves_open_begins_anew():
    driven = Driven(auto_enable=0)
    driven.ask(HAS_ENABLE, 1)
    driven.convert(100)
    driven.ask(HAS_ENABLE, 0)
    driven.ask(HAS_ENABLE, 1)
    assert driven.until(lambda: driven.own.is_on) == pytest.approx(OPENING, abs=1.1e-4)


def test_a_quick_stop_keeps_them_open_until_it_ends():
    driven = Driven(quick_stop_hold_ms=20.0)
    driven.ask(HAS_QUICK_STOP)
    driven.convert(100)
    assert driven.seen == (QUICK_STOP, True, True) and driven.own.is_stopping
    driven.convert(120)
    assert driven.seen == (DISABLED, False, False)


def test_a_quick_stop_while_they_open_begins_once_they_are_open():
    driven = Driven(auto_enable=0, quick_stop='ramp_and_hold')
    driven.ask(HAS_ENABLE, 1)
    driven.ask(HAS_QUICK_STOP)
    assert driven.seen == (QUICK_STOP, False, True) and not driven.own.is_stopping
    driven.convert(310)
    assert driven.seen == (QUICK_STOP, True, True) and driven.own.is_stopping


@pytest.mark.parametrize(('reaction', 'when_off', 'energised'), [
    (DISABLE, 1, False), (BLOCK, 1, False), (DISABLE, 0, True), (BLOCK, 0, False)])
def test_a_fault_closes_them_as_declared_and_clearing_brings_them_back(
        reaction, when_off, energised):
    driven = Driven(when_off=when_off)
    find(driven.state, reaction)
    driven.convert()
    assert driven.seen == (FAULT, False, energised)
    find(driven.state, NONE)
    driven.state.protection.clears, driven.state.protection.reaction = 0, NONE
    driven.ask(HAS_CLEAR_FAULT)
    assert driven.seen == (DISABLED, False, not when_off)
    driven.ask(HAS_ENABLE, 1)
    driven.until(lambda: driven.own.is_on)
    assert driven.seen == (ENABLED, True, True)


@pytest.mark.parametrize(('kind', 'hold', 'least', 'most'), [
    ('close', 200.0, 0.0, 2e-4), ('ramp', 20.0, 0.0195, 0.0205),
    ('ramp_and_hold', 20.0, 0.0195, 0.0205)])
def test_an_emergency_stop_stops_by_its_category_and_ends_disabled_and_blocked(
        kind, hold, least, most):
    """Category 2 too: an emergency stop is one of category 0 or 1 (IEC 60204-1)."""
    driven = Driven(when_off=0, quick_stop=kind, quick_stop_hold_ms=hold)
    driven.rules.emergency_stop = 1.0
    driven.convert()
    assert driven.own.state == QUICK_STOP and driven.own.event == EMERGENCY_STOP
    assert least <= driven.until(lambda: driven.own.state == DISABLED) <= most
    assert driven.seen == (DISABLED, False, False) and driven.own.event == STOP_ENDS


def test_while_it_lasts_nothing_is_enabled_and_after_it_everything_may_be():
    driven = Driven(quick_stop='close')
    driven.rules.emergency_stop = 1.0
    driven.convert(3)
    since = int(driven.own.since_step)
    driven.ask(HAS_ENABLE, 1)
    assert driven.seen == (DISABLED, False, False) and driven.own.refused == HAS_ENABLE
    driven.convert(50)
    assert driven.own.since_step == since   # nothing changes any more
    driven.rules.emergency_stop = 0.0
    driven.convert()
    assert driven.seen == (DISABLED, False, False)
    driven.ask(HAS_ENABLE, 1)
    assert driven.until(lambda: driven.own.is_on) == pytest.approx(OPENING, abs=1.1e-4)


def test_a_held_quick_stop_is_not_left_by_enable_and_ends_by_the_emergency_stop():
    driven = Driven(quick_stop='ramp_and_hold', quick_stop_hold_ms=5.0)
    driven.ask(HAS_QUICK_STOP)
    driven.convert(200)
    assert driven.own.state == QUICK_STOP
    driven.rules.emergency_stop = 1.0
    request(driven.state, HAS_ENABLE, 1)
    driven.convert()
    assert driven.seen == (DISABLED, False, False) and driven.own.refused == HAS_ENABLE


def test_what_still_initialises_will_be_disabled():
    driven = Driven(auto_enable=0, initialisation_ms=10.0)
    driven.own.auto_enable = 1
    assert driven.own.state == INITIALISING
    driven.rules.emergency_stop = 1.0
    driven.convert(2)
    assert driven.own.auto_enable == 0
    driven.ask(HAS_ENABLE, 1)
    assert driven.own.refused == HAS_ENABLE and driven.own.auto_enable == 0
    driven.convert(120)
    assert driven.own.state == DISABLED


def test_a_fault_and_an_emergency_stop_at_once_end_in_fault_and_are_left_one_by_one():
    driven = Driven()
    driven.rules.emergency_stop = 1.0
    find(driven.state, BLOCK)
    driven.convert(2)
    assert driven.seen == (FAULT, False, False)
    find(driven.state, NONE)
    driven.state.protection.reaction = NONE
    driven.ask(HAS_CLEAR_FAULT)
    driven.ask(HAS_ENABLE, 1)
    assert driven.seen == (DISABLED, False, False)
    driven.rules.emergency_stop = 0.0
    driven.ask(HAS_ENABLE, 1)
    driven.until(lambda: driven.own.is_on)
    assert driven.own.mode == IMPEDANCE
