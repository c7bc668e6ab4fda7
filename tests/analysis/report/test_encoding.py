"""Signals as the bytes of a page: read back as its script does, in Python."""

import base64
import zlib

from isa_ros.analysis.report.encoding import Encoder, GAP, LEVELS, quantised
from isa_ros.analysis.signals.signals import Signal
import numpy as np
import pytest

T = np.arange(1000) * 1e-3


def bytes_of(encoder: Encoder) -> np.ndarray:
    return np.frombuffer(zlib.decompress(base64.b64decode(encoder.text())), np.uint8)


def read(stored: np.ndarray, offset: int, n: int, low: float, high: float) -> np.ndarray:
    """Return values as `browser/signals.js` reads them."""
    z = stored[offset:offset + n].astype(int) | stored[offset + n:offset + 2 * n].astype(int) << 8
    signed = np.where(z & 1, -(z >> 1) - 1, z >> 1)
    levels = np.cumsum(np.cumsum(signed)) % 65536
    return np.where(levels == GAP, np.nan, low + levels * ((high - low) / LEVELS))


@pytest.mark.parametrize('values', [
    np.sin(40.0 * T), np.full(1000, -7.5), np.where(np.arange(1000) % 2, 1e308, -1e308),
    np.where(np.arange(1000) % 7, 3.0 + T, np.nan), np.linspace(2e-300, 5e-300, 1000)])
def test_values_are_read_back_within_half_a_step(values):
    """Also with gaps, jumps over the whole range, and a range that no float holds."""
    encoder = Encoder()
    stored = encoder.add(Signal(T, values))
    found = read(bytes_of(encoder), stored.offset, 1000, stored.low / 4, stored.high / 4)
    step = stored.high / 4 / LEVELS - stored.low / 4 / LEVELS
    assert (np.isnan(found) == np.isnan(values)).all()
    assert (stored.low, stored.high) == (np.nanmin(values), np.nanmax(values))
    # half a step, and the rounding of a float
    error = np.nanmax(np.abs(found - values / 4))
    assert error <= 0.5 * step * (1.0 + 1e-6) + 2e-16 * np.nanmax(np.abs(values))


def test_the_ends_of_the_range_are_exact():
    assert quantised(np.array([2.0, 4.0, np.nan, 3.0]), 2.0, 4.0).tolist() == [
        0, LEVELS, GAP, round(LEVELS / 2)]
    assert LEVELS < GAP == 65535


def test_a_signal_is_stored_once_and_columns_apart():
    values = np.stack([T, T * T], axis=1)
    encoder = Encoder()
    first, second = (encoder.add(Signal(T, values[:, k])) for k in range(2))
    assert encoder.add(Signal(T, values[:, 0])) is first
    assert (first.offset, second.offset) == (0, 2000) and first.grid == second.grid == 0
    stored = bytes_of(encoder)
    assert len(stored) == 4000
    assert read(stored, 2000, 1000, 0.0, second.high)[500] == pytest.approx(0.25, abs=1e-5)


def test_even_times_are_three_numbers():
    encoder = Encoder()
    encoder.add(Signal(2.0 + T, T))
    grid, = encoder.grids
    assert grid == {'t0': 2.0, 'step': pytest.approx(1e-3), 'n': 1000}
    one = Encoder()
    one.add(Signal(np.array([3.5]), np.array([1.0])))
    assert one.grids == [{'t0': 3.5, 'step': 1.0, 'n': 1}]


def test_uneven_times_are_stored():
    """To 2^-32 of their range: of an hour 0.8 us."""
    t = np.concatenate([T[:300], T[700:] + 0.0003])
    encoder = Encoder()
    stored = encoder.add(Signal(t, t))
    grid = encoder.grids[stored.grid]
    split = bytes_of(encoder)[grid['offset']:grid['offset'] + 4 * 600].reshape(4, 600).astype(int)
    sums = np.cumsum(split[0] + 256 * split[1] + 65536 * split[2] + 16777216 * split[3])
    found = grid['t0'] + sums * ((grid['high'] - grid['t0']) / (2 ** 32 - 1))
    assert found == pytest.approx(t, abs=1e-9) and stored.offset == 2400


def test_noise_takes_two_bytes_and_a_smooth_signal_less_than_one():
    t = np.arange(100_000) * 1e-3
    noise = np.random.default_rng(3).standard_normal(100_000)
    sizes = []
    for values in (noise, np.sin(3.0 * t)):
        encoder = Encoder()
        encoder.add(Signal(t, values))
        sizes.append(len(encoder.text()) * 0.75 / len(t))
    assert sizes[1] < 0.7 and 1.5 < sizes[0] < 2.1
