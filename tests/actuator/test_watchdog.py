"""A frozen REU: its samples stay, its frames stop, it answers nothing, and its output goes off."""

from isa_ros.core.conditions import conditions
from isa_ros.core.device import DISABLED, FAULT
from isa_ros.core.signals import HAS_CLEAR_FAULT, HAS_ENABLE, HAS_QUICK_STOP
import pytest
from tests.actuator.efforts import run
from tests.sheets import actuator_sheet, override, request, setpoint, smart_actuator, TICK

FROZEN, SOUND = {'reu.frozen': 1.0}, {'reu.frozen': 0.0}
READ = ('position', 'velocity', 'force', 'pressure_a', 'pressure_b', 'spool', 'current',
        'temperature', 'supply_pressure')


def moving(sheet=None):
    """Return an actuator that moves, with its valve open."""
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK, sheet=sheet)
    actuator.accept(setpoint(position=0.07))
    run(actuator, 12)
    assert abs(actuator.sample.velocity) > 0.1
    return actuator


def test_its_samples_stay_and_get_old():
    actuator = moving()
    before = {name: float(actuator.sample[name]) for name in READ}
    exact = float(actuator._body.plant.mechanics.position)
    actuator.tune(FROZEN)
    run(actuator, 20)
    assert {name: float(actuator.sample[name]) for name in READ} == before
    assert abs(actuator._body.plant.mechanics.position - exact) > 1e-4
    assert actuator.sample.age == pytest.approx(0.02, abs=1e-4)
    actuator.tune(SOUND)
    run(actuator, 1)
    assert actuator.sample.age == 0.0 and float(actuator.sample.position) != before['position']


def test_its_watchdog_takes_the_current_to_zero_and_says_so():
    """5 ms after the last conversion; the spool is back at null some ms later."""
    actuator = moving()
    actuator.tune(FROZEN)
    run(actuator, 4)
    assert actuator._reu.amplifier != 0.0 and not actuator.sample.trips
    run(actuator, 3)
    assert actuator._reu.amplifier == 0.0
    assert conditions(actuator.sample.trips) == ['watchdog']
    assert actuator.sample.device_state == FAULT
    assert actuator.sample.trip_value == pytest.approx(5e-3, abs=1.1e-4)
    run(actuator, 20)
    assert abs(actuator._body.plant.spool.position) < 2e-6


def test_without_a_watchdog_its_output_stays():
    actuator = moving(override(actuator_sheet('isa_v5'), 'reu.watchdog_ms', 0.0))
    actuator.tune(FROZEN)
    run(actuator, 1)
    held = float(actuator._reu.amplifier)
    run(actuator, 20)
    assert actuator._reu.amplifier == held != 0.0 and not actuator.sample.trips


def test_with_the_protection_off_the_circuit_acts_nevertheless():
    actuator = moving(override(actuator_sheet('isa_v5'), 'reu.protection.switch', 'off'))
    actuator.tune(FROZEN)
    run(actuator, 8)
    assert actuator._reu.amplifier == 0.0 and not actuator.sample.trips


def test_it_answers_no_request_and_takes_no_setpoint():
    actuator = moving()
    actuator.tune(FROZEN)
    run(actuator, 2)
    for kinds in (HAS_ENABLE, HAS_CLEAR_FAULT, HAS_QUICK_STOP):
        done, answer = actuator.request(request(kinds), 'a request')
        assert not done and answer.startswith('no answer for 0.00')
    before, unused = float(actuator._reu.setpoint.position), actuator._reu.status.unused_setpoints
    actuator.accept(setpoint(position=0.03))
    actuator.tick()
    assert actuator.applied is None and actuator._reu.setpoint.position == before
    assert actuator._reu.status.unused_setpoints == unused


def test_once_its_program_runs_again_it_waits_in_fault_until_it_is_cleared():
    """The way it went while nothing read the encoder is no jump of it."""
    actuator = moving()
    actuator.tune(FROZEN)
    run(actuator, 30)
    actuator.tune(SOUND)
    run(actuator, 2)
    assert conditions(actuator.sample.trips) == ['watchdog']
    assert actuator.request(request(HAS_CLEAR_FAULT), 'cleared')[0]
    run(actuator, 1)
    assert actuator.sample.device_state == DISABLED and not actuator.sample.trips


@pytest.mark.parametrize('ticks', [3, 7])
def test_a_snapshot_of_a_frozen_one_continues_byte_for_byte(ticks):
    actuator, twin = moving(), smart_actuator('isa_v5', 'mass', timing=TICK)
    actuator.tune(FROZEN)
    run(actuator, ticks)
    twin.restore(actuator.snapshot())
    assert run(twin, 10) == run(actuator, 10)
