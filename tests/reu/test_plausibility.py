"""What pressures, force sensor and encoder must have in common."""

from hypothesis import given, strategies as st
import numpy as np
import pytest
from tests.reu.watched import AREA_A, AREA_B, only, PERIOD, STROKE, Watched

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


@given(st.floats(-1.0, 1.0))
def test_a_jump_is_a_speed_over_one_conversion(step: float) -> None:
    watched = Watched(only('encoder_jump', trip=1.0))
    watched.state.measured.position = 0.05 + step
    watched.convert()
    assert watched.own.values[10] == abs(0.05 + step - 0.05) / PERIOD
    watched.convert()
    assert watched.own.values[10] == 0.0
