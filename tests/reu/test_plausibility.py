"""What pressures, force sensor and encoder must have in common."""

from hypothesis import given, strategies as st
from isa_ros.core.conditions import BITS
from isa_ros.core.device import CURRENT, SPOOL
import numpy as np
import pytest
from tests.reu.watched import (
    AREA_A, AREA_B, only, PERIOD, RATINGS, SPOOL_GAIN, SPOOL_LAG, STROKE, Watched)

FRICTION = 100.0


def unexplained(pressure_a: float, pressure_b: float, force: float, **motion: float) -> float:
    watched = Watched(only('load_cell_implausible', trip=0.5))
    measured = watched.state.measured
    measured.pressure_a, measured.pressure_b, measured.force = pressure_a, pressure_b, force
    measured.position = motion.get('position', 0.5 * STROKE)
    watched.state.speed.velocity = motion.get('velocity', 0.0)
    watched.step = 5  # not an instant of the speed estimate
    watched.own.evidence.acceleration = motion.get('acceleration', 0.0)
    watched.convert()
    return float(watched.own.values[9])


@given(st.floats(0.0, 22e6), st.floats(0.0, 22e6), st.floats(-1.0, 1.0), st.floats(0.0, 50.0))
def test_friction_and_inertia_explain_what_they_can(
        pressure_a: float, pressure_b: float, part: float, acceleration: float) -> None:
    """R14: any force within friction and m |a| of the hydraulic one is plausible."""
    hydraulic = AREA_A * pressure_a - AREA_B * pressure_b
    allowed = FRICTION + 1.0 * acceleration
    assert unexplained(pressure_a, pressure_b, hydraulic + 0.999 * part * allowed,
                       acceleration=acceleration) == 0.0


@given(st.floats(0.0, 22e6), st.floats(0.0, 22e6), st.floats(1.0, 5e3), st.booleans())
def test_an_offset_shows_less_friction(
        pressure_a: float, pressure_b: float, offset: float, is_up: bool) -> None:
    hydraulic = AREA_A * pressure_a - AREA_B * pressure_b
    sign = 1.0 if is_up else -1.0
    # a sum of terms up to 1e4 N is exact to some of its last digits, 1e-12 N
    assert unexplained(pressure_a, pressure_b, hydraulic + sign * (FRICTION + offset)) == (
        pytest.approx(offset, rel=0.0, abs=1e-8))


@pytest.mark.parametrize('position', [0.0, -1e-6, STROKE, STROKE + 1e-6])
def test_at_an_end_the_stop_may_take_any_force(position: float) -> None:
    assert unexplained(20e6, 0.0, 0.0, position=position) == 0.0
    assert unexplained(20e6, 0.0, 0.0) == 8000.0 - FRICTION


def test_a_force_beyond_the_range_is_read_as_its_end() -> None:
    """22 MPa on A_A are 8800 N; with 30 MPa the sensor reads its 10 kN, which is plausible."""
    assert unexplained(30e6, 0.0, 1e4) == 0.0
    assert unexplained(30e6, 0.0, 9e3) == 1e3 - FRICTION


def test_the_acceleration_is_that_of_the_speed_estimate() -> None:
    """Differenced once in each of its periods, 1 kHz."""
    watched = Watched(only('load_cell_implausible', trip=0.5))
    found = []
    for k in range(21):
        watched.state.speed.velocity = 0.01 * (1 + watched.step // 50)
        watched.convert()
        found.append(float(watched.own.evidence.acceleration))
    assert np.allclose(found, 10.0, rtol=1e-9, atol=0.0)


def test_the_acceleration_is_taken_where_the_samples_are_offset() -> None:
    """Conversions at 7, 12, 17, ... plant steps, of which every tenth ends a period."""
    watched = Watched(only('load_cell_implausible', trip=0.5))
    watched.constants.evidence.offset_steps = watched.step = 7
    found = []
    for k in range(21):
        watched.state.speed.velocity = 0.01 * (1 + k // 10)
        watched.convert()
        found.append(float(watched.own.evidence.acceleration))
    assert np.allclose(found, 10.0, rtol=1e-9, atol=0.0)


@given(st.floats(-1.0, 1.0))
def test_a_jump_is_a_speed_over_one_conversion(step: float) -> None:
    watched = Watched(only('encoder_jump', trip=1.0))
    watched.state.measured.position = 0.05 + step
    watched.convert()
    assert watched.own.values[10] == abs(0.05 + step - 0.05) / PERIOD
    watched.convert()
    assert watched.own.values[10] == 0.0


def spool_deviations(watched: Watched, n: int) -> list[float]:
    """Return the deviation of the spool at each of ``n`` conversions."""
    found = []
    for _ in range(n):
        watched.convert()
        found.append(float(watched.own.values[BITS['spool_deviation']]))
    return found


@given(st.floats(-0.1, 0.1))
def test_a_spool_is_expected_to_follow_its_reference_with_the_lag_of_its_valve(
        current: float) -> None:
    """R15: of a step of the current (T/(T + dt))^n are left; the stops bound it."""
    watched = Watched(only('spool_deviation', trip=0.5))
    watched.state.current_reference = current
    found = np.array(spool_deviations(watched, 100))  # the spool stays at null
    end = min(abs(SPOOL_GAIN * current), RATINGS.spool_stop)
    left = (SPOOL_LAG / (SPOOL_LAG + PERIOD)) ** np.arange(1, 101)
    # each conversion rounds a number up to the stop, or one without a normal form
    assert np.allclose(found, end * (1.0 - left), rtol=0.0, atol=100 * 2.3e-16 * end + 1e-300)


def test_a_spool_that_follows_with_that_lag_does_not_deviate() -> None:
    watched = Watched(only('spool_deviation', trip=0.5))
    watched.state.current_reference = 5e-3
    for _ in range(100):
        at = watched.state.measured.spool
        watched.state.measured.spool = at + PERIOD / (SPOOL_LAG + PERIOD) * (1e-4 - at)
        # the difference of two numbers of 1e-4 m
        assert spool_deviations(watched, 1)[0] <= 1e-19


def test_a_piloted_spool_has_the_reference_of_its_loop_and_none_without_it() -> None:
    watched = Watched(only('spool_deviation', trip=0.5))
    valve, state = watched.constants.evidence.valve, watched.state
    valve.is_piloted, valve.gain = 1, 1.0
    state.current_reference, state.spool_reference = 7e-3, 1e-4
    state.status.acting = SPOOL
    assert spool_deviations(watched, 300)[-1] == pytest.approx(1e-4, rel=1e-4)  # e^-10 are left
    state.status.acting, state.measured.spool = CURRENT, -5e-5
    assert spool_deviations(watched, 2) == [0.0, 0.0]
    assert watched.own.evidence.spool == -5e-5  # from where the loop begins again


def test_a_valve_without_a_spool_sensor_is_not_watched() -> None:
    watched = Watched(only('spool_deviation', trip=0.5))
    watched.constants.evidence.valve.is_watched = 0
    watched.state.current_reference = 5e-3
    assert spool_deviations(watched, 100) == [0.0] * 100
