"""A run that is saved in any state of its devices goes on byte for byte."""

from isa_ros.controller import Setpoint
from isa_ros.core.conditions import BITS
from isa_ros.core.device import (
    DISABLED, ENABLED, FAULT, FAULT_REACTION, INITIALISING, QUICK_STOP)
from isa_ros.core.signals import COMMAND
from isa_ros.requests import fill_command
import numpy as np
import pytest
from tests.sheets import actuator_sheet, override, setpoint, smart_actuator

TICKS = 60
FAILED, RATED = 1e6, 20.7e6   # Pa gauge
TRIP = float(1 << BITS['supply_low'])


def commanded(actuator, **values):
    """Let a command take effect at the next tick."""
    command = np.zeros(1, COMMAND)[0]
    fill_command(actuator.name, Setpoint(**values), command)
    actuator.accept(command)


def supply(actuator, pressure):
    """Let the supply have a pressure, Pa gauge."""
    actuator.memory.ports['supply_pressure'] = pressure


REACHED = {
    INITIALISING: lambda own: None,
    DISABLED: lambda own: commanded(own, is_enabled=False),
    ENABLED: lambda own: commanded(own, mode='spool', spool=1e-5),
    QUICK_STOP: lambda own: commanded(own, quick_stop=True),
    FAULT_REACTION: lambda own: supply(own, FAILED),
    FAULT: lambda own: supply(own, FAILED)}


def started(state):
    """Return a moving actuator; one that initialises does so for longer than the test."""
    sheet = actuator_sheet('isa_v5')
    if state == INITIALISING:
        sheet = override(sheet, 'reu.device.initialisation_ms', 50.0)
    sheet = override(sheet, 'reu.protection.supply_low.delay_ms', 0.0)
    if state == FAULT_REACTION:
        sheet = override(sheet, 'reu.protection.supply_low.reaction', 'quick_stop')
    actuator = smart_actuator('isa_v5', 'mass', sheet=sheet)
    actuator.accept(setpoint(position=0.055))
    return actuator


def ticked(actuator, ticks=TICKS):
    """Return the samples of some ticks as bytes."""
    samples = []
    for _ in range(ticks):
        actuator.tick()
        samples.append(actuator.sample.tobytes())
    return samples


@pytest.mark.parametrize('state', REACHED)
def test_saved_in_any_state_it_goes_on_byte_for_byte(state):
    """Two ticks into the state, so that a stop and a fade are on their way."""
    whole, later = started(state), started(state)
    ticked(whole)
    REACHED[state](whole)
    ticked(whole, 2)
    assert whole.sample.device_state == state
    later.restore(whole.snapshot())
    for own in (whole, later):
        commanded(own, is_enabled=True)
    assert ticked(whole) == ticked(later)
    assert whole.snapshot() == later.snapshot()


def test_a_fault_outlives_its_cause_and_is_cleared_in_a_restored_run():
    whole, restored = started(FAULT), started(FAULT)
    ticked(whole)
    supply(whole, FAILED)
    ticked(whole, 2)
    supply(whole, RATED)
    ticked(whole, 2)
    restored.restore(whole.snapshot())
    assert (restored.sample.device_state, restored.sample.trips) == (FAULT, TRIP)
    commanded(restored, clear_fault=True, is_enabled=True)
    ticked(restored, 2)
    assert (restored.sample.device_state, restored.sample.trips) == (ENABLED, 0.0)
