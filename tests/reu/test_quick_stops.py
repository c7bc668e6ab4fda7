"""Quick stops of a device: how they brake, how long they last, and what they end in."""

from isa_ros.actuator.sheet import actuator_record
from isa_ros.core.device import CURRENT, DISABLED, ENABLED, FAULT, FAULT_REACTION, QUICK_STOP
from isa_ros.core.record import row_record
from isa_ros.core.signals import HAS_ENABLE, HAS_QUICK_STOP
from isa_ros.reu import device
import numpy as np
import pytest
from tests.reu.devices import constants, find, PERIOD, QUICK_STOPS, request, STOP_STEPS
from tests.reu.states import enabled_state
from tests.sheets import actuator_sheet


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


def test_without_a_position_block_a_quick_stop_ramps_the_flow_too():
    """The reference of the valve is that of the flow: at half the speed less than at all of it."""
    sheet = actuator_sheet('isa_v5', 'default', 'valve_amplifier')
    reu = row_record(actuator_record(sheet, 0)).reu
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
