"""The hardware watchdog alone: what passes while a frozen program runs no block."""

from isa_ros.core.conditions import BITS, conditions
from isa_ros.core.device import ENABLED, FAULT
from isa_ros.reu.protection import note_trip
from isa_ros.reu.watchdog import stand_still
import pytest
from tests.reu.devices import constants, PERIOD
from tests.reu.states import enabled_state

CONVERSION = PERIOD * 20e-6     # s
FIVE_MS = round(5e-3 / CONVERSION)


class Frozen:
    """An enabled REU whose program stands still, with current in its valve."""

    def __init__(self, switch=1, opening=0.0):
        self.reu = constants()
        self.reu.protection.is_on, self.reu.rules.opening = switch, opening
        self.state, self.step = enabled_state(self.reu), 0
        self.own = self.state.protection
        self.state.drive = 5e-3
        self.state.status.is_energised = self.state.status.is_open = 1
        self.state.status.switched = -1

    def pass_by(self, conversions):
        for _ in range(conversions):
            stand_still(self.step, CONVERSION, self.reu, self.state)
            self.step += PERIOD


def test_the_output_stays_for_its_time_and_then_goes_off_with_a_fault():
    """5 ms: the condition trips and the device is in fault at the same conversion."""
    frozen = Frozen()
    frozen.pass_by(FIVE_MS - 1)
    assert frozen.state.drive == 5e-3 and frozen.state.status.state == ENABLED
    frozen.pass_by(2)
    assert frozen.state.drive == 0.0 and frozen.state.status.state == FAULT
    assert conditions(float(frozen.own.trips)) == ['watchdog']
    assert frozen.own.first == frozen.own.trips
    bit = BITS['watchdog']
    assert frozen.own.trip_values[bit] == pytest.approx(5e-3, abs=1.1 * CONVERSION)
    since, value = frozen.own.trip_since[bit], frozen.own.trip_values[bit]
    frozen.pass_by(100)     # it trips once
    assert (frozen.own.trip_since[bit], frozen.own.trip_values[bit]) == (since, value)
    assert frozen.own.values[bit] == value      # and is judged no more
    assert frozen.state.frozen_for == pytest.approx((FIVE_MS + 101) * CONVERSION)


@pytest.mark.parametrize('cause', ['overload', 'runaway'])
def test_what_tripped_before_stays_the_first_cause(cause):
    """Whether its bit is below that of the watchdog or above it."""
    frozen, bit = Frozen(), BITS[cause]
    note_trip(bit, 0, 5e3, frozen.own)
    frozen.own.trips = frozen.own.first = 1 << bit
    frozen.pass_by(FIVE_MS + 1)
    assert set(conditions(float(frozen.own.trips))) == {cause, 'watchdog'}
    assert conditions(float(frozen.own.first)) == [cause]


def test_with_the_protection_off_the_circuit_acts_alone():
    frozen = Frozen(switch=0)
    frozen.pass_by(FIVE_MS + 1)
    assert frozen.state.drive == 0.0 and frozen.own.trips == 0
    assert frozen.state.status.state == ENABLED


def test_without_a_watchdog_the_output_stays():
    frozen = Frozen()
    frozen.reu.watchdog = 0.0
    frozen.pass_by(1000)
    assert frozen.state.drive == 5e-3 and frozen.own.trips == 0


@pytest.mark.parametrize('opening', [0.0, 0.03])
def test_the_emergency_stop_needs_no_program(opening):
    """At once, before the watchdog's time; block valves lose their current, if there are any."""
    frozen = Frozen(opening=opening)
    frozen.reu.rules.emergency_stop = 1.0
    frozen.pass_by(1)
    status = frozen.state.status
    assert frozen.state.drive == 0.0 and frozen.own.trips == 0
    valves = (status.is_on, status.is_open, status.is_energised, status.switched)
    assert valves == ((1, 1, 1, -1) if opening == 0.0 else (0, 0, 0, 0))
    frozen.pass_by(5)
    assert status.switched == valves[3]     # switched once
