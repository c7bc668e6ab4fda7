"""The spool: bandwidths of equations 7 and 8, null bias, stop, compiled == Python."""

import math

from hypothesis import given, strategies as st
from isa_ros.core.record import row_record
from isa_ros.plant import coil, spool
from isa_ros.plant.plant import plant_record
import numpy as np
import pytest
from scipy.optimize import brentq
from tests.sheets import actuator_sheet, MODELS, override, plant_row

MANIFOLD = plant_row('smart_manifold')
ISA_V2 = plant_row('isa_v2')
EXPLICIT = plant_record(actuator_sheet('isa_v5', 'table_4', 'explicit').plant)[0]


def valve_state(*values: float) -> np.record:
    """Return a `SPOOL_STATE` row."""
    return row_record(np.array([values or (0.0, 0.0, 0.0)], spool.SPOOL_STATE))


def linear(plant: np.record, with_current_pole: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return (A, b) from reference to spool, differenced from the kernels, which are linear."""
    def rates(y: np.ndarray, u: float) -> np.ndarray:
        own, out = valve_state(*y[:3]), valve_state()
        spool.spool_rates(
            own, y[3] if with_current_pole else u, plant.valve.k_spool, plant.spool, out)
        amplifier = coil.current_rate(y[3], u, plant.coil)
        return np.array([out.position, out.velocity, out.acceleration, amplifier])
    # small enough for the voltage limit
    matrix = np.array([rates(1e-6 * e, 0.0) for e in np.eye(4)]).T / 1e-6
    return matrix, rates(np.zeros(4), 1e-6) / 1e-6


def minus_3_db(plant: np.record, with_current_pole: bool = False) -> float:
    """Return the frequency (Hz) at which the spool lags 3 dB behind K_spool i."""
    matrix, column = linear(plant, with_current_pole)
    moving = [0, 1] if plant.spool.kind == spool.DIRECT else [0, 1, 2]
    if with_current_pole:
        moving.append(3)
    matrix, column = matrix[np.ix_(moving, moving)], column[moving]

    def gain(hz: float) -> float:
        response = np.linalg.solve(
            2j * math.pi * hz * np.eye(len(moving)) - matrix, column)
        return abs(response[0]) / plant.valve.k_spool - math.sqrt(0.5)
    return brentq(gain, 1.0, 2000.0)


def test_closed_spool_loop_bandwidth():
    """V3 (eq 8 alone): -3 dB at 114.1 Hz, physics.md section 4."""
    assert minus_3_db(MANIFOLD) == pytest.approx(114.1, abs=1.0)


def test_spool_behind_the_current_loop_bandwidth():
    """V1 + V3: eq 8 after eq 10 reaches 100 to 120 Hz, errata 20."""
    assert 100.0 <= minus_3_db(MANIFOLD, with_current_pole=True) <= 120.0


def test_high_response_spool_bandwidth():
    """V10 (eq 7): 320 +-10 Hz against the actual current, errata 19."""
    assert minus_3_db(ISA_V2) == pytest.approx(320.0, abs=10.0)


def test_piloted_spool_with_its_loop_is_equation_8():
    """V13: K_p K_pilot of Table 4 and the assumed pilot is K_loop = 540 1/s within 0.5 %."""
    sheet = actuator_sheet('isa_v5', 'table_4', 'explicit')
    per_metre = sheet.reu.spool.kp  # A per m of error
    assert per_metre * EXPLICIT.spool.k_pilot == pytest.approx(540.0, rel=5e-3)
    own = valve_state(2e-5, 1e-3, 3.0)
    error = 5e-5 - own.position
    closed = spool.spool_jerk(5e-5, own, MANIFOLD.spool)
    opened = spool.piloted_jerk(540.0 / EXPLICIT.spool.k_pilot * error, own, EXPLICIT.spool)
    assert opened == pytest.approx(closed, rel=1e-12)


@pytest.mark.parametrize('model', MODELS)
def test_no_null_bias_at_the_reference_conditions(model):
    """V12: 20.7 MPa, no return pressure, 40 degC."""
    assert spool.null_bias(20.7e6, 0.0, plant_row(model).spool) == 0.0


def test_null_bias_shifts_as_a_data_sheet_says():
    """V12: 2 % of 5 mA for 7 MPa less supply, 3.5 MPa of return, 38 K of oil, on the MFB valve."""
    own = MANIFOLD.spool
    assert spool.null_bias(13.7e6, 0.0, own) == pytest.approx(-0.1e-3, rel=0.03)
    assert spool.null_bias(20.7e6, 3.5e6, own) == pytest.approx(0.1e-3, rel=0.03)
    warm = plant_record(
        override(actuator_sheet('smart_manifold'), 'plant.oil.temperature_celsius', 78.0).plant)[0]
    assert spool.null_bias(20.7e6, 0.0, warm.spool) == pytest.approx(0.1e-3, rel=0.03)


def test_electric_feedback_is_ten_times_less_sensitive():
    """V12, section 2.6: the ISA v5's null moves much less than the manifold's."""
    electric = spool.null_bias(13.7e6, 1e6, plant_row('isa_v5').spool)
    mechanic = spool.null_bias(13.7e6, 1e6, MANIFOLD.spool)
    assert electric == pytest.approx(0.1 * mechanic, rel=1e-3)


@given(x=st.floats(-1e-3, 1e-3), v=st.floats(-1.0, 1.0))
def test_the_stop_holds_the_spool(x, v):
    """Beyond 0.178 mm the spool is at the stop, without speed into it."""
    y, x_max = valve_state(x, v, 1.0), MANIFOLD.valve.x_max
    spool.stop_spool(y, x_max)
    assert abs(y.position) <= x_max
    if abs(x) > x_max:
        assert y.velocity * y.position <= 0.0
    else:
        assert (y.position, y.velocity) == (x, v)


@given(beyond=st.floats(1e-9, 1e-3), v=st.floats(1e-9, 1.0), a=st.floats(-1e4, 1e4),
       side=st.sampled_from([1.0, -1.0]))
def test_the_stop_takes_speed_and_acceleration_of_a_spool_that_runs_into_it(beyond, v, a, side):
    """What a plastic stop holds is at rest; one that kept x'' would move on in V3 as if free."""
    x_max = MANIFOLD.valve.x_max
    y = valve_state(side * (x_max + beyond), side * v, side * a)
    spool.stop_spool(y, x_max)
    assert (y.position, y.velocity, y.acceleration) == (side * x_max, 0.0, 0.0)


@given(v=st.floats(0.0, 1.0), a=st.floats(-1e4, 1e4), side=st.sampled_from([1.0, -1.0]))
def test_the_stop_lets_a_spool_go_that_leaves_it(v, a, side):
    """A stop pushes and never pulls: speed away from it stays, and so does its acceleration."""
    x_max = MANIFOLD.valve.x_max
    y = valve_state(side * (x_max + 1e-9), -side * v, side * a)
    spool.stop_spool(y, x_max)
    assert (y.position, y.velocity, y.acceleration) == (side * x_max, -side * v, side * a)


@given(current=st.floats(-5e-3, 5e-3), x=st.floats(-2e-4, 2e-4), v=st.floats(-0.2, 0.2))
def test_compiled_rates_equal_their_python_source(current, x, v):
    """All three kinds of spool."""
    for plant in (MANIFOLD, ISA_V2, EXPLICIT):
        y, compiled, python = valve_state(x, v, 7.0), valve_state(), valve_state()
        spool.spool_rates(y, current, plant.valve.k_spool, plant.spool, compiled)
        spool.spool_rates.py_func(y, current, plant.valve.k_spool, plant.spool, python)
        assert compiled.tobytes() == python.tobytes()
