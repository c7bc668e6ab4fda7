"""The temperature that the REU and the topics have."""

from dataclasses import replace
import math

from hypothesis import given, strategies as st
from isa_ros.core.parameter import defaults
from isa_ros.core.record import rows_of
from isa_ros.errors import ParameterError
from isa_ros.plant.temperature_sensor import (
    read_temperature, TEMPERATURE_SENSOR, temperature_sensor_record, TemperatureSensor)
import numpy as np
import pytest

IDEAL = defaults(TemperatureSensor)
KEY, STEPS = np.uint64(5), 50
N = 4000


def sensor(**values: float) -> np.record:
    rows = rows_of(1, TEMPERATURE_SENSOR)
    rows[0] = temperature_sensor_record(replace(IDEAL, **values))
    own: np.record = rows[0]
    return own


def readings(celsius: float, n: int = N, **values: float) -> np.ndarray:
    """Return the readings at the ends of ``n`` ticks of 1 ms."""
    own = sensor(**values)
    return np.array([read_temperature(k * STEPS, celsius, KEY, own, 0.0) for k in range(1, n + 1)])


@given(st.floats(-60.0, 200.0), st.integers(0, 10**9))
def test_an_ideal_sensor_reads_the_temperature_to_the_last_bit(celsius, step):
    assert read_temperature(step, celsius, KEY, sensor(), 0.0) == celsius


@given(st.floats(-60.0, 200.0))
def test_a_reading_is_the_nearest_whole_step(celsius):
    """S4, with 0.25 K, which is a power of two and has no rounding."""
    read = read_temperature(STEPS, celsius, KEY, sensor(resolution=0.25), 0.0)
    assert abs(read - celsius) <= 0.125 and (read / 0.25).is_integer()


def test_an_error_is_constant_and_grows():
    found = readings(40.0, bias=0.5, drift_per_s=2.0)
    t = np.arange(1, N + 1) * STEPS * 20e-6
    # sums of numbers up to 50, of which a double has 16 digits
    assert np.allclose(found, 40.0 + 0.5 + 2.0 * t, rtol=0.0, atol=3e-14)


def test_its_noise_has_the_standard_deviation_and_no_memory():
    """Of N values the standard deviation is within 5/sqrt(2 N), a correlation within 5/sqrt(N)."""
    noise = (readings(40.0, sigma=0.2) - 40.0) / 0.2
    assert abs(noise.std() - 1.0) < 5.0 / math.sqrt(2.0 * N)
    assert abs(noise.mean()) < 5.0 / math.sqrt(N)
    assert abs(np.corrcoef(noise[1:], noise[:-1])[0, 1]) < 5.0 / math.sqrt(N)
    assert (readings(40.0, 20, sigma=0.2) == readings(40.0, 20, sigma=0.2)).all()


def test_a_stuck_sensor_keeps_its_reading_and_has_one_at_first():
    own = sensor(stuck=1.0, bias=1.0)
    assert read_temperature(0, 40.0, KEY, own, 0.0) == 41.0
    assert read_temperature(STEPS, 60.0, KEY, own, 41.0) == 41.0


@pytest.mark.parametrize(('values', 'message'), [
    ({'stuck': 0.5}, 'stuck = 0.5, must be 0 or 1'),
    ({'sigma': -1.0}, 'TemperatureSensor.sigma = -1 K, must be >= 0 K')])
def test_a_sensor_that_cannot_be_is_refused(values, message):
    with pytest.raises(ParameterError, match=message):
        replace(IDEAL, **values)


@given(st.floats(-60.0, 200.0), st.integers(0, 10**9))
def test_compiled_equals_python(celsius, step):
    own = sensor(sigma=0.1, bias=0.3, drift_per_s=0.01, resolution=0.1)
    assert read_temperature(step, celsius, KEY, own, 0.0) == read_temperature.py_func(
        step, celsius, KEY, own, 0.0)
