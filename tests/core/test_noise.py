"""The noise: the published vectors of its hash, its distribution, independence, equal bits."""

from itertools import combinations
import math

from isa_ros.core.kernel import kernel
from isa_ros.core.noise import LARGEST_SEED, noise_key, normal, philox, uniforms
import numpy as np
import pytest
from scipy import stats

N = 200_000
ALARM = 1e-6
"""Probability with which a check would refuse numbers that are truly random."""
LAGS = 100
VECTORS = [
    ('00000000 00000000 00000000 00000000', '00000000 00000000',
     '6627e8d5 e169c58d bc57ac4c 9b00dbd8'),
    ('ffffffff ffffffff ffffffff ffffffff', 'ffffffff ffffffff',
     '408f276d 41c83b0e a20bc7c6 6d5451fd'),
    ('243f6a88 85a308d3 13198a2e 03707344', 'a4093822 299f31d0',
     'd16cfe09 94fdcceb 5001e420 24126ea1')]
"""Counter, key and result of philox4x32 with 10 rounds, from kat_vectors of Random123."""


@kernel
def fill(key, channel, numbers):
    """Fill the noise of the first steps."""
    for step in range(len(numbers)):
        numbers[step] = normal(key, step, channel)


def series(seed: int = 0, name: str = 'knee', channel: int = 0, n: int = N) -> np.ndarray:
    """Return the noise of one channel over ``n`` steps."""
    numbers = np.empty(n)
    fill(np.uint64(noise_key(seed, name)), channel, numbers)
    return numbers


def bound(n_checks: int = 1) -> float:
    """Return the deviation, in standard deviations, that ``n_checks`` normal numbers exceed."""
    return float(stats.norm.isf(ALARM / (2 * n_checks)))


def words(text: str) -> list[np.uint64]:
    """Return words of hexadecimal digits."""
    return [np.uint64(int(word, 16)) for word in text.split()]


@pytest.mark.parametrize('counter, key, result', VECTORS)
def test_hash_gives_the_published_vectors(counter, key, result):
    for compute in (philox, philox.py_func):
        assert list(compute(*words(counter), *words(key))) == words(result)


def test_compiled_noise_equals_its_python_source():
    key = np.uint64(noise_key(7, 'knee'))
    for step in (0, 1, 5, 2**32 - 1, 2**32, 2**40 + 3):
        for channel in (0, 5, 100):
            assert normal(key, step, channel) == normal.py_func(key, step, channel)
            assert uniforms(key, step, channel) == uniforms.py_func(key, step, channel)


def test_mean_variance_and_shape_are_those_of_the_standard_normal_distribution():
    """Standard errors of the moments of N normal numbers: roots of 1/N, 2/N, 6/N, 24/N."""
    noise = series()
    moments = [noise.mean(), noise.var() - 1.0, stats.skew(noise), stats.kurtosis(noise)]
    errors = np.sqrt(np.array([1.0, 2.0, 6.0, 24.0]) / N)
    assert (np.abs(moments) < bound(4) * errors).all()
    assert stats.kstest(noise, 'norm').pvalue > ALARM


def test_noise_is_white():
    """The correlation of white noise at a lag has the standard error 1/sqrt(N)."""
    noise = series()
    at_lags = [noise[:-lag] @ noise[lag:] / N for lag in range(1, LAGS + 1)]
    assert np.abs(at_lags).max() < bound(LAGS) / math.sqrt(N)
    power = np.abs(np.fft.rfft(noise)[1:-1]) ** 2 / N       # exponential, of mean 1
    assert stats.kstest(power, 'expon').pvalue > ALARM


def test_channels_seeds_and_actuators_are_independent():
    """Also their squares, so that no two are large at the same time."""
    sources = [
        *(series(channel=channel) for channel in range(6)), series(seed=1), series(seed=2),
        series(name='hip'), series(name='knee2'), series(channel=1, name='hip')]
    pairs = list(combinations(sources, 2))
    for power in (1, 2):
        spread = 1.0 if power == 1 else 2.0     # variance of a normal number, of its square
        correlated = [
            np.mean((a ** power - (power - 1)) * (b ** power - (power - 1))) / spread
            for a, b in pairs]
        assert np.abs(correlated).max() < bound(2 * len(pairs)) / math.sqrt(N)


def test_a_uniform_number_is_in_its_range_and_even():
    key = np.uint64(noise_key(0, 'knee'))
    numbers = np.array([uniforms(key, step, 0) for step in range(20_000)])
    assert (numbers >= 0.0).all() and (numbers < 1.0).all()
    for column in numbers.T:
        assert stats.kstest(column, 'uniform').pvalue > ALARM


def test_the_largest_number_is_finite():
    """1 - u is 2^-53 at least."""
    assert math.sqrt(-2.0 * math.log(2.0 ** -53)) == pytest.approx(8.57, abs=0.01)
    assert np.isfinite(series()).all()


def test_keys_differ_for_every_seed_and_name():
    keys = {noise_key(seed, name) for seed in (0, 1, 11, LARGEST_SEED)
            for name in ('knee', 'hip', '1knee')}
    assert len(keys) == 12
    assert all(0 <= key < 2**64 for key in keys)
