"""One control block: law, filters, saturation, anti-windup, scheduling, compensation."""

from dataclasses import replace

from hypothesis import given, strategies as st
from isa_ros.core.record import rows_of
from isa_ros.plant import servo_valve
from isa_ros.reu import block
from isa_ros.reu.compensation import dual_gain_compensation, Linear
from isa_ros.reu.schedule import POINTS
import numpy as np
import pytest
from tests.sheets import actuator_sheet, plant_row

SHEET = actuator_sheet('isa_v5').reu.force
STROKE = 0.1
PERIOD = 1.0 / SHEET.rate_hz
demands = st.floats(-2e-3, 2e-3)


def record(sheet: block.Pid = SHEET, factor: float = 1.0, **changes: object) -> np.record:
    """Return the `BLOCK` record of a sheet with some values replaced."""
    return block.block_record(replace(sheet, **changes), np.full(POINTS, factor))


LOOP = record()


def state() -> np.record:
    """Return a block at rest."""
    return rows_of(1, block.BLOCK_STATE)[0]


def step(
        loop: np.record, own: np.record, reference: float, measured: float,
        velocity: float = 0.0) -> float:
    """Run one period at mid stroke and return the output."""
    block.block_step(reference, measured, velocity, 0.5 * STROKE, STROKE, loop, own)
    return float(own.output)


def test_first_period_is_proportional_then_the_integral_grows():
    """R3: K_p e in the first period, K_i T e more in the next."""
    own = state()
    first = step(LOOP, own, 100.0, 0.0)
    assert first == pytest.approx(SHEET.kp * 100.0)
    # a difference of outputs some 100 times as large, rounded to 1e-16 of them
    assert step(LOOP, own, 100.0, 0.0) - first == pytest.approx(
        SHEET.ki * PERIOD * 100.0, rel=1e-12, abs=0.0)


def test_velocity_compensation_adds_its_flow():
    """R3: K_v v without any force error, below the knee."""
    assert step(LOOP, state(), 0.0, 0.0, 0.02) == pytest.approx(SHEET.kv * 0.02)


def test_feedback_damping_opposes_a_rising_force():
    """R3: a force rising at r settles to - K_p K_f r, damped in the proportional part only."""
    loop = record(feedback_damping='proportional')
    own, rate = state(), 1e4
    for n in range(1, 200):
        output = step(loop, own, rate * n * PERIOD, rate * n * PERIOD)
    assert own.measured_rate == pytest.approx(rate, rel=1e-9)
    assert output == pytest.approx(-SHEET.kp * SHEET.kf * rate, rel=1e-9, abs=0.0)


def test_damping_before_the_pid_is_that_of_a_measured_value_ahead():
    """R13: u = (K_p + K_i/s)(r - y - K_f y') is the PI law without K_f on y + K_f y'."""
    ahead = record(kf=0.0)
    own, led = state(), state()
    for n in range(1, 200):
        measured = 50.0 * np.sin(0.1 * n)
        output = step(LOOP, own, 30.0, measured)
        led_output = step(ahead, led, 30.0, measured + SHEET.kf * own.measured_rate)
        # both outputs are sums of terms of up to K_p 100 N, rounded to 1e-16 of them
        assert output == pytest.approx(led_output, rel=0.0, abs=1e-13 * SHEET.kp * 100.0)
    assert abs(own.integral) > 1e-8


def test_derivative_acts_on_the_error():
    """R3: an error growing at r adds K_d r, whether reference or measured value changes."""
    loop = record(kp=0.0, ki=0.0, kd=1e-9)
    for sign in (1.0, -1.0):
        own, rate = state(), 1e4
        for n in range(1, 200):
            growing = rate * n * PERIOD
            output = step(loop, own, *((growing, 0.0) if sign > 0.0 else (0.0, growing)))
        assert output == pytest.approx(sign * 1e-9 * rate, rel=1e-9, abs=0.0)


def test_reference_feed_forward_and_offset_add_to_the_demand():
    """R3: K_r r + u_0."""
    loop = record(kp=0.0, ki=0.0, kr=1e-8, offset=5e-6)
    assert step(loop, state(), 1000.0, 0.0) == pytest.approx(1e-5 + 5e-6)


def test_measured_filter_smooths_what_the_block_sees():
    """R1: 100 Hz at 5 kHz lets 1 - exp(-2 pi 0.02) of a step through in the first period."""
    own = state()
    step(record(measured_filter_hz=100.0), own, 0.0, 1.0)
    assert own.measured == pytest.approx(1.0 - np.exp(-2.0 * np.pi * 0.02))
    step(LOOP, own, 0.0, 1.0)
    assert own.measured == 1.0


def test_schedule_scales_proportional_and_integral_gain():
    """R6: half the gain, half the response."""
    full, half, halved = state(), state(), record(factor=0.5)
    for _ in range(2):
        step(LOOP, full, 100.0, 0.0)
        step(halved, half, 100.0, 0.0)
    assert half.output == pytest.approx(0.5 * full.output, rel=1e-12, abs=0.0)


def test_a_retracting_demand_is_scaled():
    """R7: only demands below zero."""
    loop = record(retracting_factor=0.5)
    assert step(loop, state(), 100.0, 0.0) == step(LOOP, state(), 100.0, 0.0)
    assert step(loop, state(), -100.0, 0.0) == 0.5 * step(LOOP, state(), -100.0, 0.0)


def test_a_retracting_demand_is_scaled_before_the_flow_curve_is_inverted():
    """R7, R4: half the demand is half the flow, on both sides of the knee."""
    valve, loop = plant_row('isa_v5').valve, record(retracting_factor=0.5, ki=0.0)
    for demand in (3e-5, 6e-5, 3e-4):  # m; the knee is at 42.7 um
        spools = [step(own, state(), -demand / SHEET.kp, 0.0) for own in (record(ki=0.0), loop)]
        whole, half = (servo_valve.flow_curve(-x, valve) for x in spools)
        assert half == pytest.approx(0.5 * whole, rel=1e-12, abs=0.0)


@given(demand=demands)
def test_compensation_inverts_the_flow_curve(demand):
    """R4, V4: with the compensation the land's flow is proportional to the demand."""
    valve = plant_row('isa_v5').valve
    spool = dual_gain_compensation(demand, LOOP.compensation)
    flow = servo_valve.flow_curve(abs(spool), valve)
    assert flow == pytest.approx(valve.k_low * abs(demand), rel=1e-12, abs=1e-18)
    assert spool == -dual_gain_compensation(-demand, LOOP.compensation)


def test_the_paper_s_text_compensates_the_velocity_alone():
    """R4, errata 23: with `applies_to: velocity` a large force error passes unchanged."""
    loop = record(compensation=replace(SHEET.compensation, applies_to='velocity'))
    demand = 1e-4  # m, beyond the knee of 42.7 um
    error = demand / SHEET.kp
    assert step(loop, state(), error, 0.0) == pytest.approx(demand)
    of_speed = step(loop, state(), 0.0, 0.0, demand / SHEET.kv)
    assert of_speed == pytest.approx(4.27e-5 + 0.16 * (demand - 4.27e-5))
    assert step(record(compensation=Linear()), state(), error, 0.0) == pytest.approx(demand)


def test_output_saturates_and_the_integral_stands_still():
    """R5: at the stop the error drives the integral no further."""
    own = state()
    for _ in range(2000):
        output = step(LOOP, own, 7500.0, 0.0, 1.0)
    assert output == LOOP.limit
    held = own.integral
    step(LOOP, own, 7500.0, 0.0, 1.0)
    assert own.integral == held


def test_without_anti_windup_the_integral_winds_up():
    """Without anti-windup the integral winds up, which R5 prevents."""
    own, loop = state(), record(anti_windup='none')
    for _ in range(2000):
        step(loop, own, 7500.0, 0.0, 1.0)
    assert own.integral == pytest.approx(SHEET.ki * 2000 * PERIOD * 7500.0, rel=1e-9)


def wound(anti_windup: str, error: float, integral: float, factor: float = 1.0) -> float:
    """Return the integral after a period, over K_i T e w, by which it moves as ever."""
    own, loop = state(), record(anti_windup=anti_windup, kf=0.0, factor=factor)
    own.integral = integral
    step(loop, own, error, 0.0)
    return float((own.integral - integral) / (SHEET.ki * PERIOD * error * factor))


def test_an_integral_that_a_large_error_opposes_unwinds_eight_times_as_fast() -> None:
    """R22: in both directions, from a tenth of the limit on, with the gain of the schedule."""
    large = 0.1 * LOOP.limit / LOOP.kp
    for sign in (1.0, -1.0):
        held = -sign * 0.2 * LOOP.limit
        assert wound('unwinding', sign * 1.01 * large, held) == pytest.approx(8.0, rel=1e-6)
        assert wound('unwinding', sign * 0.99 * large, held) == pytest.approx(1.0, rel=1e-6)
        assert wound('unwinding', sign * 1.01 * large, -held) == pytest.approx(1.0, rel=1e-6)
        assert wound('clamped', sign * 1.01 * large, held) == pytest.approx(1.0, rel=1e-6)
        assert wound('unwinding', sign * 0.6 * large, held, 2.0) == pytest.approx(8.0, rel=1e-6)
    assert block.UNWINDING == 8.0


def test_an_integral_unwinds_to_zero_and_not_beyond() -> None:
    """R22: from there on it grows as ever."""
    own, loop = state(), record(anti_windup='unwinding', kf=0.0)
    large = 0.2 * LOOP.limit / LOOP.kp
    own.integral = -3.0 * SHEET.ki * PERIOD * large
    step(loop, own, large, 0.0)
    assert own.integral == 0.0
    step(loop, own, large, 0.0)
    assert own.integral == pytest.approx(SHEET.ki * PERIOD * large, rel=1e-12, abs=0.0)


def test_an_unwinding_integral_is_held_while_the_output_is_saturated() -> None:
    """R5 stays in force."""
    own, loop = state(), record(anti_windup='unwinding')
    own.integral = held = 0.1 * LOOP.limit
    assert step(loop, own, 7500.0, 0.0, 1.0) == LOOP.limit
    assert own.integral == held


def test_a_saturated_block_leaves_the_stop_at_once_when_the_error_turns():
    """R5: no windup to unwind, the first opposite error leaves saturation."""
    own = state()
    for _ in range(5000):
        step(LOOP, own, 7500.0, 0.0)
    assert step(LOOP, own, -7500.0, 0.0) < LOOP.limit


@given(reference=st.floats(-7500.0, 7500.0), force=st.floats(-7500.0, 7500.0),
       velocity=st.floats(-1.0, 1.0), place=st.floats(-0.01, 0.11))
def test_compiled_block_equals_its_python_source(reference, force, velocity, place):
    """One period, every state."""
    loop = record(kd=1e-10, kr=1e-9, measured_filter_hz=800.0, retracting_factor=0.8,
                  anti_windup='unwinding')
    compiled, python = state(), state()
    compiled.integral = python.integral = 1e-4
    block.block_step(reference, force, velocity, place, STROKE, loop, compiled)
    block.block_step.py_func(reference, force, velocity, place, STROKE, loop, python)
    assert compiled.tobytes() == python.tobytes()
