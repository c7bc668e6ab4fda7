"""The command that took effect says what the device made of it, after the device's step."""

from isa_ros.core.device import DISABLED, ENABLED, FAULT
from isa_ros.core.signals import (
    HAS_CLEAR_FAULT, HAS_ENABLE, HAS_QUICK_STOP, HAS_SETPOINT, WAS_REFUSED)
from isa_ros.scripting.run import load
from isa_ros.testing import assert_replays
from isa_ros.tick.trips import TripWarning
import pytest
from tests.actuator.efforts import run
from tests.sheets import request, setpoint, smart_actuator, TICK

LOST = {'plant.sensors.force.bias': 4000.0}


@pytest.fixture
def faulted():
    """Return an actuator whose device is in fault, with its cause still there."""
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    actuator.tune(LOST)
    run(actuator, 80)
    assert actuator.sample.device_state == FAULT
    return actuator


def applied(actuator, command):
    """Return (kinds, is_enabled) of what took effect in the tick after a command."""
    actuator.accept(command)
    actuator.tick()
    return int(actuator.applied.kinds), int(actuator.applied.is_enabled)


def counts(actuator):
    return int(actuator.sample.unused_setpoints), int(actuator.sample.refused_requests)


def test_in_a_fault_a_setpoint_is_applied_as_not_enabled_and_counted(faulted):
    before = counts(faulted)[0]
    assert applied(faulted, setpoint(position=0.05)) == (HAS_SETPOINT, 0)
    assert counts(faulted) == (before + 1, 0)


def test_in_the_tick_of_its_trip_it_is_not_enabled_either():
    """The trip comes within the tick at whose start the setpoint took effect."""
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    actuator.tune(LOST)
    states = []
    for _ in range(80):
        found = applied(actuator, setpoint(position=0.05))
        states.append((int(actuator.sample.device_state), found[1]))
    assert set(states) == {(ENABLED, 1), (FAULT, 0)}


def test_an_enable_that_a_fault_refuses_is_told_as_refused_and_counted(faulted):
    assert applied(faulted, request(HAS_ENABLE, 1)) == (HAS_ENABLE | WAS_REFUSED, 0)
    assert applied(faulted, request(HAS_CLEAR_FAULT)) == (HAS_CLEAR_FAULT, 0)
    assert applied(faulted, request(HAS_QUICK_STOP)) == (HAS_QUICK_STOP, 0)
    assert counts(faulted)[1] == 3
    assert applied(faulted, request(HAS_ENABLE, 0)) == (HAS_ENABLE, 0)
    assert counts(faulted)[1] == 3, 'it is disabled, as was asked'


def test_once_the_cause_is_gone_the_requests_are_taken(faulted):
    faulted.tune(dict.fromkeys(LOST, 0.0))
    run(faulted, 2)
    assert applied(faulted, request(HAS_CLEAR_FAULT)) == (HAS_CLEAR_FAULT, 0)
    assert faulted.sample.device_state == DISABLED
    assert applied(faulted, request(HAS_ENABLE, 1)) == (HAS_ENABLE, 1)
    assert applied(faulted, request(HAS_ENABLE, 1)) == (HAS_ENABLE, 1)
    assert counts(faulted)[1] == 0
    assert applied(faulted, request(HAS_ENABLE, 0)) == (HAS_ENABLE, 0)


def test_a_run_with_refused_requests_replays_to_the_byte(tmp_path):
    """An enable in the tick of the trip, in the fault, and with a quick stop."""
    rig = load('rig_linear', {'name': 'asked', 'duration_s': 0.13, 'tracks': {'ram': [
        {'t_s': 0.0, 'position': 'hold'}, {'t_s': 0.06, 'enabled': True},
        {'t_s': 0.08, 'enabled': True}, {'t_s': 0.085, 'enabled': True, 'quick_stop': True},
        {'t_s': 0.09, 'enabled': False},
        {'t_s': 0.1, 'clear_fault': True, 'enabled': True, 'position': 0.05}]}})
    with pytest.warns(TripWarning, match='4 requests|3 requests'):
        result = rig.simulate(faults=[
            {'t_s': 0.03, 'actuator': 'ram', 'fault': 'pressure_a_lost', 'until_s': 0.095}])
    assert_replays(result.save(tmp_path / 'bag'))
