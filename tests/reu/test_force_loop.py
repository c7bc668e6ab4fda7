"""Force loop: law, dual-gain compensation, saturation and anti-windup."""

from hypothesis import given, strategies as st
from isa_ros.plant import servo_valve
from isa_ros.reu import force_loop
import numpy as np
import pytest
from tests.sheets import actuator_sheet, plant_row

SHEET = actuator_sheet('isa_v5').reu
LOOP = np.array(
    [force_loop.force_loop_record(SHEET.force, SHEET.compensation)],
    force_loop.FORCE_LOOP).view(np.recarray)[0]
PERIOD = 1.0 / SHEET.force.rate_hz
demands = st.floats(-2e-3, 2e-3)


def state() -> np.record:
    """Return a loop at rest."""
    return np.zeros(1, force_loop.FORCE_STATE).view(np.recarray)[0]


def test_first_period_is_proportional_then_the_integral_grows():
    """R3: K_p e in the first period, K_i T e more in the next."""
    loop = state()
    force_loop.force_loop_step(100.0, 0.0, 0.0, 1.0, LOOP, loop)
    first = loop.output
    assert first == pytest.approx(SHEET.force.kp * 100.0)
    force_loop.force_loop_step(100.0, 0.0, 0.0, 1.0, LOOP, loop)
    assert loop.output - first == pytest.approx(SHEET.force.ki * PERIOD * 100.0)


def test_velocity_compensation_adds_its_flow():
    """R3: K_v v without any force error, below the knee."""
    loop = state()
    force_loop.force_loop_step(0.0, 0.0, 0.02, 1.0, LOOP, loop)
    assert loop.output == pytest.approx(SHEET.force.kv * 0.02)


def test_force_damping_opposes_a_rising_force():
    """R3: a force rising at r settles to - K_p K_f r."""
    loop, rate = state(), 1e4
    for n in range(1, 200):
        force = rate * n * PERIOD
        force_loop.force_loop_step(force, force, 0.0, 1.0, LOOP, loop)
    assert loop.force_rate == pytest.approx(rate, rel=1e-9)
    assert loop.output == pytest.approx(-SHEET.force.kp * SHEET.force.kf * rate, rel=1e-9)


def test_schedule_scales_both_gains():
    """R6: half the gain, half the response."""
    full, half = state(), state()
    for _ in range(2):
        force_loop.force_loop_step(100.0, 0.0, 0.0, 1.0, LOOP, full)
        force_loop.force_loop_step(100.0, 0.0, 0.0, 0.5, LOOP, half)
    assert half.output == pytest.approx(0.5 * full.output, rel=1e-12)


@given(demand=demands)
def test_compensation_inverts_the_flow_curve(demand):
    """R4, V4: behind the compensation the land's flow is proportional to the demand."""
    valve = plant_row('isa_v5').valve
    spool = force_loop.dual_gain_compensation(demand, LOOP)
    flow = servo_valve.flow_curve(abs(spool), valve)
    assert flow == pytest.approx(valve.k_low * abs(demand), rel=1e-12, abs=1e-18)
    assert spool == -force_loop.dual_gain_compensation(-demand, LOOP)


def test_output_saturates_and_the_integral_stands_still():
    """R5: at the stop the error drives the integral no further."""
    loop = state()
    for _ in range(2000):
        force_loop.force_loop_step(7500.0, 0.0, 1.0, 1.0, LOOP, loop)
    assert loop.output == LOOP.limit
    held = loop.integral
    force_loop.force_loop_step(7500.0, 0.0, 1.0, 1.0, LOOP, loop)
    assert loop.integral == held


def test_a_saturated_loop_leaves_the_stop_at_once_when_the_error_turns():
    """R5: no windup to unwind, the first opposite error leaves saturation."""
    loop = state()
    for _ in range(5000):
        force_loop.force_loop_step(7500.0, 0.0, 0.0, 1.0, LOOP, loop)
    bound = LOOP.limit
    force_loop.force_loop_step(-7500.0, 0.0, 0.0, 1.0, LOOP, loop)
    assert loop.output < bound


@given(reference=st.floats(-7500.0, 7500.0), force=st.floats(-7500.0, 7500.0),
       velocity=st.floats(-1.0, 1.0))
def test_compiled_loop_equals_its_python_source(reference, force, velocity):
    """One period, every state."""
    compiled, python = state(), state()
    force_loop.force_loop_step(reference, force, velocity, 0.7, LOOP, compiled)
    force_loop.force_loop_step.py_func(reference, force, velocity, 0.7, LOOP, python)
    assert compiled.tobytes() == python.tobytes()
