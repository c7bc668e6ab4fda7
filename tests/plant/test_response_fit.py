"""A spool with the stated points of a frequency response, at a small and a large amplitude."""

import math

from hypothesis import given, strategies as st
from isa_ros.errors import ParameterError
from isa_ros.plant.response_fit import (
    damping_of, gain_at, leading, passed_at_3db, passed_at_90, response_at, saturated, SecondOrder,
    speed_limit)
from isa_ros.plant.spool import limited_acceleration, ResponseSpool, spool_record
import numpy as np
import pytest
from scipy.integrate import solve_ivp

SHEET = ResponseSpool(
    minus_90_deg_hz=120.0, minus_3_db_hz=100.0, large_percent=90.0, large_minus_90_deg_hz=60.0,
    large_minus_3_db_hz=0.0)
OWN = SecondOrder(SHEET.natural_frequency_rad_per_s, SHEET.damping_ratio)
TRAVEL = 0.5e-3


@given(at_90=st.floats(1.0, 1e3), ratio=st.floats(0.11, 1.55))
def test_both_points_of_the_small_amplitude_are_on_the_response(at_90, ratio):
    """V28: of H = w_n^2/(w_n^2 - w^2 + 2 zeta w_n w j)."""
    own = SecondOrder(2.0 * math.pi * at_90, damping_of(at_90, ratio * at_90))
    assert gain_at(own, at_90, 1.0).real == pytest.approx(0.0, abs=1e-12 / own.zeta + 1e-12)
    # near 1.554 zeta^2 is a difference of numbers near 0.5
    assert abs(gain_at(own, ratio * at_90, 1.0)) == pytest.approx(math.sqrt(0.5), rel=1e-9)


def simulated(frequency: float, limit: float) -> complex:
    """Return the first harmonic of V29 under a sine of amplitude 1, by an own solver."""
    w, most = 2.0 * math.pi * frequency, 2.0 * OWN.zeta * OWN.w_n * limit

    def rates(t, y):
        pull = OWN.w_n ** 2 * (math.sin(w * t) - y[0])
        return [y[1], max(-most, min(most, pull)) - 2.0 * OWN.zeta * OWN.w_n * y[1]]
    period = 1.0 / frequency
    t = np.linspace(6.0 * period, 8.0 * period, 2001)
    y = solve_ivp(rates, (0.0, 8.0 * period), [0.0, 0.0], t_eval=t, max_step=period / 200.0,
                  rtol=1e-8, atol=1e-10).y[0]
    return complex(2j * np.trapezoid(y * np.exp(-1j * w * t), t) / (2.0 * period))


@pytest.mark.parametrize('at', [80.0, 60.0, 40.0])
def test_the_limited_spool_has_minus_90_degrees_where_it_is_stated(at):
    """V29: within 1.6 degrees, the part of the third harmonic that comes back."""
    n = passed_at_90(OWN, at)
    limit = speed_limit(OWN, at, n)
    assert np.degrees(np.angle(response_at(OWN, at, limit))) == pytest.approx(-90.0, abs=1e-6)
    found = simulated(at, limit)
    assert np.degrees(np.angle(found)) == pytest.approx(-90.0, abs=1.6)
    assert abs(found) == pytest.approx(abs(gain_at(OWN, at, n)), rel=0.01)


@pytest.mark.parametrize('at', [90.0, 60.0, 40.0])
def test_or_minus_3_db(at):
    n = passed_at_3db(OWN, at)
    assert abs(gain_at(OWN, at, n)) == pytest.approx(math.sqrt(0.5), rel=1e-11)
    limit = speed_limit(OWN, at, n)
    assert abs(simulated(at, limit)) == pytest.approx(math.sqrt(0.5), rel=0.03)


def test_the_saturation_passes_what_fourier_says():
    """N of a clipped sine by its first coefficient."""
    angle = np.linspace(0.0, 2.0 * np.pi, 200_001)[:-1]
    for share in (0.05, 0.3, 0.7, 0.99):
        clipped = np.clip(np.sin(angle), -share, share)
        assert saturated(share) == pytest.approx(
            2.0 * np.mean(clipped * np.sin(angle)), rel=1e-6)
    assert saturated(1.0) == saturated(3.0) == 1.0


def test_the_record_has_the_speed_of_the_large_amplitude():
    record = spool_record(SHEET, 40.0, TRAVEL)
    limit = speed_limit(OWN, 60.0, passed_at_90(OWN, 60.0))
    assert record.v_max == pytest.approx(0.9 * TRAVEL * limit, rel=1e-12, abs=0.0)
    assert (record.w_n, record.zeta) == (OWN.w_n, OWN.zeta)


@pytest.mark.parametrize('far', [-1e-3, -1e-6, 0.0, 1e-6, 1e-3])
def test_within_its_limit_a_spool_is_one_of_equation_7(far):
    """V10, and beyond it the speed goes to v_max; compiled equal to Python."""
    record = spool_record(SHEET, 40.0, TRAVEL)
    damping = 2.0 * record.zeta * record.w_n
    found = limited_acceleration(far, 0.0, 0.1, record)
    assert found == limited_acceleration.py_func(far, 0.0, 0.1, record)
    pull = record.w_n ** 2 * far
    if abs(pull) < damping * record.v_max:
        assert found == pytest.approx(pull - damping * 0.1, rel=1e-12)
    else:
        assert found == pytest.approx(damping * (math.copysign(record.v_max, far) - 0.1), rel=1e-9)
    assert (abs(far) == 1e-3) == (abs(pull) >= damping * record.v_max)


def changed(**values: float) -> ResponseSpool:
    """Return the sheet with other points."""
    own = {'minus_90_deg_hz': 120.0, 'minus_3_db_hz': 100.0, 'large_percent': 90.0,
           'large_minus_90_deg_hz': 0.0, 'large_minus_3_db_hz': 0.0}
    return ResponseSpool(**own | values)


@pytest.mark.parametrize('values', [
    {}, {'large_minus_90_deg_hz': 120.0}, {'large_minus_3_db_hz': 100.0}])
def test_a_large_amplitude_as_fast_as_a_small_one_has_no_limit(values):
    assert changed(**values).limit == 0.0


def test_of_two_points_at_the_large_amplitude_the_phase_is_taken():
    both = changed(large_minus_90_deg_hz=60.0, large_minus_3_db_hz=50.0)
    assert both.limit == SHEET.limit
    assert changed(large_minus_3_db_hz=50.0).limit != SHEET.limit


@pytest.mark.parametrize(('values', 'message'), [
    ({'minus_3_db_hz': 190.0}, 'minus_3_db_hz = 190 Hz, must be < 186.5 Hz, 1.554 times minus_'),
    ({'minus_3_db_hz': 5.0}, 'minus_3_db_hz = 5 Hz and minus_90_deg_hz = 120 Hz need a damping '
                             'ratio of 12, must be <= 5'),
    ({'large_minus_90_deg_hz': 130.0},
     'large_minus_90_deg_hz = 130 Hz, must be <= minus_90_deg_hz = 120 Hz'),
    ({'large_minus_3_db_hz': 101.0},
     'large_minus_3_db_hz = 101 Hz, must be <= minus_3_db_hz = 100 Hz'),
    ({'minus_90_deg_hz': 0.0}, 'minus_90_deg_hz = 0 Hz, must be > 0 Hz')])
def test_points_that_contradict_each_other_are_refused_with_both(values, message):
    with pytest.raises(ParameterError, match=message):
        changed(**values)


@pytest.mark.parametrize(('at_90', 'at_3db', 'lag'), [
    (80.0, 70.0, 5.4), (120.0, 150.0, 12.0), (60.0, 20.0, 3.0)])
def test_a_spool_in_front_of_a_lag_leads_by_it(at_90, at_3db, lag):
    """-90 degrees with the lag, and the stated -3 dB."""
    alone = leading(at_90, at_3db, np.tan(np.radians(lag)))
    own = SecondOrder(2.0 * np.pi * alone, damping_of(alone, at_3db))
    assert np.degrees(np.angle(gain_at(own, at_90, 1.0))) == pytest.approx(lag - 90.0, abs=1e-9)
    assert abs(gain_at(own, at_3db, 1.0)) == pytest.approx(np.sqrt(0.5), rel=1e-11, abs=0.0)
    assert leading(at_90, at_3db, 0.0) == pytest.approx(at_90, rel=1e-11)
