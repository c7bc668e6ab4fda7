"""Why a device would not follow a setpoint, as it is told to who moves one."""

from isa_ros.core.device import DISABLED, ENABLED, FAULT, INITIALISING, QUICK_STOP
from isa_ros.core.signals import HAS_CLEAR_FAULT, HAS_ENABLE, HAS_QUICK_STOP
import pytest
from tests.actuator.protected import clear, protected, ticks
from tests.actuator.test_watchdog import FROZEN, moving
from tests.sheets import actuator_sheet, override, request, setpoint, smart_actuator, TICK


def follows(actuator) -> bool:
    """Send a setpoint, run some ticks; return whether it is what the loops follow."""
    own = actuator._reu.status
    actuator.accept(setpoint(position=0.0601))
    ticks(actuator, 3)
    return bool(own.is_on and not own.is_stopping and not own.is_damping
                and actuator.sample.position_reference == 0.0601)


def test_an_enabled_one_follows_at_once_and_after_some_time():
    actuator = protected()
    assert actuator.deafness == '' and follows(actuator)
    ticks(actuator, 20)
    assert actuator.deafness == '' and follows(actuator)


@pytest.mark.parametrize('sent, state, why', [
    (request(HAS_ENABLE, 0), DISABLED, 'the state is disabled'),
    (request(HAS_QUICK_STOP), QUICK_STOP, 'the state is quick stop')])
def test_one_that_is_not_enabled_does_not(sent, state, why):
    actuator = protected()
    ticks(actuator, 5)
    actuator.accept(sent)
    ticks(actuator, 5)
    assert actuator.sample.device_state == state
    assert actuator.deafness == why and not follows(actuator)


def test_one_in_fault_does_not_until_it_is_cleared_and_enabled():
    """The requests that wait for the next tick count, as the device takes them first."""
    actuator = moving()
    actuator.tune(FROZEN)
    ticks(actuator, 10)
    actuator.tune({'reu.frozen': 0.0})
    ticks(actuator, 2)
    assert actuator.sample.device_state == FAULT
    assert actuator.deafness == 'the state is fault' and not follows(actuator)
    actuator.accept(request(HAS_CLEAR_FAULT))
    assert actuator.deafness == 'the state is disabled'
    clear(actuator)
    assert actuator.deafness == '' and follows(actuator)
    assert actuator.sample.device_state == ENABLED


def test_a_frozen_one_takes_none():
    actuator = moving()
    actuator.tune(FROZEN)
    ticks(actuator, 2)
    assert actuator.deafness.startswith('no answer for 0.00')


@pytest.mark.parametrize('is_wanted', [True, False])
def test_one_that_initialises_will_follow_if_it_is_to_be_enabled(is_wanted):
    sheet = override(actuator_sheet('isa_v5'), 'reu.device.initialisation_ms', 100.0)
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK, sheet=sheet)
    ticks(actuator, 3)
    assert actuator.sample.device_state == INITIALISING and actuator.deafness == ''
    actuator.accept(request(HAS_ENABLE, 0))
    assert actuator.deafness == 'the state is initialising'
    ticks(actuator, 3)
    assert actuator.deafness == 'the state is initialising'
    actuator.accept(request(HAS_ENABLE, int(is_wanted)))
    assert (actuator.deafness == '') == is_wanted
    actuator.accept(setpoint(position=0.0601))
    ticks(actuator, 120)
    assert (actuator._reu.status.is_on, actuator.sample.position_reference) == (is_wanted, 0.0601)
    assert (actuator.deafness == '') == is_wanted


def test_a_stop_that_waits_for_the_next_tick_counts():
    actuator = protected()
    ticks(actuator, 5)
    actuator.accept(request(HAS_QUICK_STOP))
    assert actuator.deafness == 'the state is quick stop' and not follows(actuator)
    assert actuator.sample.device_state == QUICK_STOP


def test_a_held_stop_is_left_by_the_enabling_that_waits():
    sheet = override(actuator_sheet('isa_v5'), 'reu.device.quick_stop', 'ramp_and_hold')
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK, sheet=sheet)
    ticks(actuator, 5)
    actuator.accept(request(HAS_QUICK_STOP))
    ticks(actuator, 300)
    assert actuator.sample.device_state == QUICK_STOP
    assert actuator.deafness == 'the state is quick stop'
    actuator.accept(request(HAS_ENABLE, 1))
    assert actuator.deafness == ''
    actuator.accept(setpoint(position=0.0601))
    ticks(actuator, 3)
    assert actuator.sample.device_state == ENABLED
    assert actuator._reu.setpoint.position == 0.0601


@pytest.mark.parametrize('reaction', ['hold', 'damp'])
def test_one_that_holds_after_a_lost_setpoint_follows_the_next(reaction):
    """The trip ends with it; of another trip it does not."""
    actuator = protected(setpoint_timeout_ms=20.0, setpoint_timeout_reaction=reaction)
    actuator.accept(setpoint(position=0.06))
    ticks(actuator, 30)
    assert actuator.sample.trips == 1.0 and actuator.deafness == ''
    actuator.accept(setpoint(position=0.055))
    ticks(actuator, 2)
    assert actuator.sample.trips == 0.0
    assert actuator._reu.setpoint.position == 0.055


@pytest.mark.parametrize('reaction, why', [
    ('warn', ''), ('hold', 'tripped: overspeed'), ('damp', 'tripped: overspeed')])
def test_one_that_holds_after_another_trip_does_not(reaction, why):
    actuator = protected(
        setpoint_timeout_ms=1000.0, overspeed__reaction=reaction,
        overspeed__warning=0.0, overspeed__trip=0.02, overspeed__delay_ms=0.0)
    ticks(actuator, 5)
    for _ in range(8):
        actuator.accept(setpoint(position=0.09))
        actuator.tick()
    assert actuator.sample.trips and actuator.deafness == why
    assert follows(actuator) == (not why)
