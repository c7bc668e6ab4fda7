"""Protection of a whole actuator: what trips, when, and what it does then."""

from isa_ros.core.conditions import BITS, conditions
from isa_ros.core.device import ENABLED, FAULT, FAULT_REACTION, FORCE, SPOOL
from isa_ros.core.signals import COMMAND, HAS_MODE, HAS_REFERENCE, HAS_SETPOINT
from isa_ros.errors import ConfigError
import numpy as np
import pytest
from tests.actuator.protected import (
    clear, CONVERSION_STEPS, OFFSET_STEPS, own, protected, TICK, ticks)
from tests.sheets import actuator_sheet, override, setpoint, smart_actuator


def test_the_watchdog_holds_until_the_next_setpoint() -> None:
    """20 ms are 200 conversions after the first one with the setpoint; one more is too late."""
    actuator = protected(setpoint_timeout_ms=20.0)
    ticks(actuator, 30)
    assert actuator.sample.trips == 0.0  # no setpoint yet
    actuator.accept(setpoint(position=0.06))
    ticks(actuator, 20)
    assert actuator.sample.trips == 0.0
    ticks(actuator, 1)
    assert conditions(actuator.sample.trips) == ['setpoint_timeout']
    first = 30 * 50 + OFFSET_STEPS % CONVERSION_STEPS
    assert own(actuator).trip_since[0] == first + 201 * CONVERSION_STEPS
    assert 0.05 < actuator.sample.position_reference < 0.06
    ticks(actuator, 300)
    held = actuator.sample.position_reference
    assert actuator.sample.position == pytest.approx(held, abs=3e-5)
    ticks(actuator, 50)
    assert actuator.sample.position_reference == held


def test_after_a_hold_it_goes_to_the_next_setpoint_with_the_declared_speed() -> None:
    """20 mm at 0.1 m/s need 200 ms, during which position and force are continuous."""
    actuator = protected(setpoint_timeout_ms=20.0)
    actuator.accept(setpoint(position=0.06))
    ticks(actuator, 400)
    held, speeds = float(actuator.sample.position), []
    target, force = held - 0.02, float(actuator.sample.force)
    for k in range(260):
        if k % 10 == 0:
            actuator.accept(setpoint(position=target))
        ticks(actuator, 1)
        speeds.append(abs(float(actuator.sample.velocity)))
        if k == 0:
            assert actuator.sample.trips == 0.0
            assert actuator.sample.position_reference == pytest.approx(held, abs=2e-4)
            assert actuator.sample.force_reference == pytest.approx(force, abs=50.0)
        if k == 190:
            assert actuator.sample.position_reference > target
    assert actuator.sample.position_reference == target
    assert 0.095 < max(speeds) < 0.15


def test_a_reference_of_the_spool_is_a_setpoint_for_the_watchdog() -> None:
    actuator = protected(setpoint_timeout_ms=20.0, setpoint_timeout_reaction='disable')
    command = np.zeros(1, COMMAND)[0]
    command['kinds'], command['mode'] = HAS_MODE | HAS_REFERENCE, SPOOL
    for _ in range(4):
        actuator.accept(command)
        ticks(actuator, 10)
        command['kinds'] = HAS_REFERENCE
    assert actuator.sample.trips == 0.0
    ticks(actuator, 11)
    assert conditions(actuator.sample.trips) == ['setpoint_timeout']


def test_the_watchdog_damps() -> None:
    """The force reference is that of the damping alone, at the speed that the REU estimates."""
    actuator = protected(setpoint_timeout_ms=5.0, setpoint_timeout_reaction='damp')
    actuator.accept(setpoint(position=0.08))
    ticks(actuator, 6)
    assert actuator.sample.trips == 1.0 and abs(actuator.sample.velocity) > 1e-3
    for _ in range(5):
        ticks(actuator, 1)
        damping = actuator.memory.reu['setpoint']['damping'][0]
        assert actuator.sample.force_reference == -damping * actuator.sample.velocity


def test_in_the_mode_of_the_force_damp_stops_quickly() -> None:
    """
    With a force of 0 N the load of 50 kg would go on at its 0.04 m/s, 7.6 mm in 190 ms.

    v^2/2a + v T are 0.08 mm + 0.11 mm at 10 m/s2.
    """
    actuator = protected(setpoint_timeout_ms=20.0, setpoint_timeout_reaction='damp')
    command = setpoint(effort=100.0)
    command['kinds'], command['mode'] = HAS_SETPOINT | HAS_MODE, FORCE
    actuator.accept(command)
    ticks(actuator, 22)
    assert conditions(actuator.sample.trips) == ['setpoint_timeout']
    assert actuator.sample.device_state == FAULT_REACTION
    at = float(actuator.sample.position)
    ticks(actuator, 190)
    assert 0.0 < actuator.sample.position - at < 2.5e-4
    assert abs(actuator.sample.velocity) < 1e-3
    ticks(actuator, 50)
    assert actuator.sample.device_state == FAULT and actuator.sample.current_reference == 0.0
    clear(actuator)
    ticks(actuator, 1)
    assert (actuator.sample.device_state, actuator.sample.trips) == (ENABLED, 0.0)


@pytest.mark.parametrize('variant', ['valve_amplifier', 'pressure_control'])
def test_without_any_position_block_the_watchdog_holds_by_the_valve(variant: str) -> None:
    """It stays enabled, at rest; the next setpoint is in force at once."""
    sheet = actuator_sheet('isa_v5', 'default', variant)
    for key, value in (('timeout_ms', 5.0), ('timeout_reaction', 'hold')):
        sheet = override(sheet, f'reu.protection.setpoint_{key}', value)
    actuator = smart_actuator('isa_v5', 'mass', sheet=sheet, timing=TICK)
    effort = 2e-3 if variant == 'valve_amplifier' else 2e6
    actuator.accept(setpoint(effort=effort))
    ticks(actuator, 5)
    assert actuator.sample.current_reference != 0.0
    ticks(actuator, 1)
    assert conditions(actuator.sample.trips) == ['setpoint_timeout']
    assert actuator.sample.device_state == ENABLED
    ticks(actuator, 300)    # four time constants of the loop that holds it, 1/14 s
    at = float(actuator.sample.position)
    ticks(actuator, 100)
    assert actuator.sample.position == pytest.approx(at, abs=5e-5)
    begin = float(actuator.sample.position)
    actuator.accept(setpoint(effort=effort))
    ticks(actuator, 5)
    assert actuator.sample.trips == 0.0
    assert actuator.sample.position > begin + 5e-6  # twice of what it drifts by, and it fades in


def test_a_tripped_actuator_is_in_fault_until_it_is_cleared() -> None:
    """The supply fails: after 10 ms the valve is at null, and stays there when it is back."""
    actuator = protected()
    port = actuator.memory.ports[0].copy()
    actuator.accept(setpoint(position=0.06))
    ticks(actuator, 5)
    failed = port.copy()
    failed['supply_pressure'] = 1e6
    for _ in range(10):
        actuator.tick(failed)
    assert conditions(actuator.sample.warnings) == [] and actuator.sample.trips == 0.0
    actuator.tick(failed)
    assert conditions(actuator.sample.trips) == ['supply_low']
    cause = BITS['supply_low']
    assert own(actuator).first == 1 << cause
    assert own(actuator).trip_values[cause] == pytest.approx(1e6)
    for _ in range(50):
        actuator.tick(port)
        actuator.accept(setpoint(position=0.06))
    assert conditions(actuator.sample.trips) == ['supply_low']
    assert actuator.sample.current_reference == 0.0
    assert actuator.sample.device_state == FAULT
    before = actuator.sample.position
    clear(actuator)
    ticks(actuator, 1)
    assert actuator.sample.trips == 0.0
    actuator.accept(setpoint(position=0.06))
    ticks(actuator, 200)
    assert abs(actuator.sample.position - 0.06) < 0.5 * abs(before - 0.06)


@pytest.mark.parametrize(('celsius', 'names'), [(60.0, []), (60.1, ['overtemperature'])])
def test_oil_that_is_too_warm_trips(celsius: float, names: list[str]) -> None:
    """For longer than 100 ms, with oil of constant temperature as with oil that losses heat."""
    sheet = override(actuator_sheet('isa_v5'), 'reu.protection.overtemperature.warning', 60.0)
    sheet = override(sheet, 'reu.protection.overtemperature.trip', 60.0)
    actuator = smart_actuator(
        'isa_v5', 'mass', sheet=override(sheet, 'plant.oil.temperature_celsius', celsius),
        timing=TICK)
    ticks(actuator, 100)
    assert actuator.sample.trips == 0.0
    ticks(actuator, 2)
    assert conditions(actuator.sample.trips) == names


def test_what_trips_is_the_temperature_that_is_sensed() -> None:
    """Oil of 40 celsius: a sensor with 45 K too many trips after its 100 ms, and is published."""
    actuator = protected()
    ticks(actuator, 10)
    assert actuator.sample.temperature == 40.0
    actuator.tune({'plant.sensors.temperature.bias': 45.0})
    ticks(actuator, 101)
    assert (actuator.sample.temperature, actuator.sample.trips) == (85.0, 0.0)
    ticks(actuator, 1)
    assert conditions(actuator.sample.trips) == ['overtemperature']
    actuator.tune({'plant.sensors.temperature.bias': 0.0, 'plant.sensors.temperature.stuck': 1.0})
    ticks(actuator, 5)
    assert actuator.sample.temperature == 85.0


def test_limit_stops_the_piston_before_the_end() -> None:
    """With the limit at 10 % of the stroke it stops after 90 %, and comes back at once."""
    found = []
    for levels in ({}, {'end_of_stroke__trip': 0.1}):
        actuator = protected(**levels)
        actuator.accept(setpoint(position=0.1))
        ticks(actuator, 1500)
        found.append(float(actuator.sample.position))
    assert found[0] > 0.098 and 0.09 < found[1] < 0.094
    actuator.accept(setpoint(position=0.05))
    ticks(actuator, 300)
    assert actuator.sample.trips == 0.0 and actuator.sample.position < 0.08


def test_a_snapshot_in_the_middle_of_a_delay_continues_it() -> None:
    """Byte for byte, to the same trip at the same step."""
    actuator, twin = (protected(setpoint_timeout_ms=30.0, setpoint_timeout_reaction='disable')
                      for _ in range(2))
    actuator.accept(setpoint(position=0.06))
    ticks(actuator, 17)
    twin.restore(actuator.snapshot())
    ticks(actuator, 40)
    ticks(twin, 40)
    assert actuator.sample.trips == 1.0
    assert twin.snapshot() == actuator.snapshot()


def test_a_timeout_shorter_than_a_tick_is_refused_during_a_run_too() -> None:
    actuator, key = protected(), 'reu.protection.setpoint_timeout_ms'
    with pytest.raises(ConfigError, match=(
            'setpoint_timeout_ms = 0.9 ms, must be >= step_ms = 1 ms, as setpoints come once')):
        actuator.tune({key: 0.9})
    for accepted in (1.0, 0.0):
        actuator.tune({key: accepted})
        assert actuator.tuning.value(key) == accepted


def test_a_start_forgets_what_has_tripped() -> None:
    actuator = protected(setpoint_timeout_ms=1.0, setpoint_timeout_reaction='disable')
    actuator.accept(setpoint(position=0.06))
    ticks(actuator, 5)
    assert actuator.sample.trips
    actuator.start(0.05, 0.0, 20.7e6, 0.0)
    ticks(actuator, 5)
    assert (actuator.sample.trips, own(actuator).first) == (0.0, 0)
