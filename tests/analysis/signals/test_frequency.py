"""Frequency response of known systems: sine fit, stepped sine, chirp, bandwidth, margins."""

import math

from isa_ros.analysis.signals.frequency import (
    bandwidth, chirp_response, fit_sine, margins, Response, stepped_response, Window)
from isa_ros.errors import AnalysisError
import numpy as np
import pytest
from scipy import signal

RATE = 10_000.0


def response_of(system: signal.lti, frequency: np.ndarray) -> Response:
    """Return the exact response of a system as a measured one."""
    value = system.freqresp(2.0 * math.pi * frequency)[1]
    ones = np.ones(len(frequency))
    return Response(frequency, value, ones, ones, np.abs(value))


def first_order(corner_hz: float) -> signal.lti:
    """Return 1 / (1 + s / w_c)."""
    w = 2.0 * math.pi * corner_hz
    return signal.lti([w], [1.0, w])


def answer(system: signal.lti, u: np.ndarray) -> np.ndarray:
    """Return the exact response of a system to samples held over each period."""
    discrete = signal.cont2discrete((system.num, system.den), 1.0 / RATE)
    return signal.lfilter(discrete[0].ravel(), discrete[1], u)


def held(system: signal.lti, frequency: np.ndarray) -> np.ndarray:
    """Return the response of `answer`, the hold included."""
    discrete = signal.cont2discrete((system.num, system.den), 1.0 / RATE)
    return signal.freqz(discrete[0].ravel(), discrete[1], frequency, fs=RATE)[1]


def stepped(frequencies: list[float], amplitude: float) -> tuple[np.ndarray, list[Window]]:
    """Return a second of each frequency, and the last half of each as its window."""
    t = np.arange(int(RATE)) / RATE
    n = len(t)
    return (np.concatenate([amplitude * np.sin(2.0 * math.pi * f * t) for f in frequencies]),
            [Window(f, k * n + n // 2, (k + 1) * n) for k, f in enumerate(frequencies)])


def test_fit_recovers_amplitude_phase_and_offset():
    """An offset and a harmonic are orthogonal to the sine over whole cycles."""
    t = np.arange(1000) / RATE
    y = 3.0 + 2.0 * np.cos(2.0 * math.pi * 50.0 * t + 0.7) + 0.5 * np.sin(
        2.0 * math.pi * 100.0 * t)
    fit = fit_sine(y, 50.0, RATE)
    # rounding of 1000 terms of size 5: 1000 * 5 * 2.2e-16
    assert fit.amplitude == pytest.approx(2.0 * complex(math.cos(0.7), math.sin(0.7)), abs=1e-12)
    assert fit.offset == pytest.approx(3.0, abs=1e-12)
    # variances 2 and 0.125 of the two sines
    assert fit.explained == pytest.approx(2.0 / 2.125, abs=1e-12)


def test_fit_leaves_out_what_is_not_a_whole_cycle():
    """The incomplete cycle at the start, here with another offset, has no influence."""
    y = np.sin(2.0 * math.pi * 10.0 * np.arange(2300) / RATE)
    y[:300] += 100.0
    assert fit_sine(y, 10.0, RATE).explained == pytest.approx(1.0, abs=1e-12)


def test_a_signal_that_stands_still_is_not_explained():
    fit = fit_sine(np.full(1000, 0.1), 50.0, RATE)
    assert (fit.amplitude, fit.explained) == (0j, 0.0)
    # the mean of 1000 equal values, rounded
    assert fit.offset == pytest.approx(0.1, abs=1e-14)


@pytest.mark.parametrize('corner', [5.0, 40.0, 300.0])
def test_stepped_sine_measures_a_first_order_lag(corner):
    """1 / (1 + j f / f_c), with the hold of the samples."""
    frequencies = [2.0, 10.0, 50.0, 250.0]
    u, windows = stepped(frequencies, 2.0)
    system = first_order(corner)
    got = stepped_response(windows, u, answer(system, u), RATE)
    # half a second of settling leaves exp(-2 pi 5 0.5) = 1.5e-7 of a jump of at most 2
    assert got.value == pytest.approx(held(system, np.array(frequencies)), abs=1e-6)
    assert got.input_amplitude == pytest.approx(2.0, abs=1e-9)
    assert got.output_amplitude == pytest.approx(2.0 * got.gain, abs=1e-6)
    assert got.coherence == pytest.approx(1.0, abs=1e-6)


def test_stepped_sine_measures_a_delay_as_phase():
    """A delay of 5 ms is 1.8 deg/Hz, beyond any number of turns."""
    frequencies = [10.0, 50.0, 90.0, 130.0, 170.0]
    u, windows = stepped(frequencies, 1.0)
    got = stepped_response(windows, u, np.roll(u, 50), RATE)
    assert got.gain == pytest.approx(1.0, abs=1e-9)
    assert got.phase == pytest.approx(-1.8 * np.array(frequencies), abs=1e-6)


def test_stepped_sine_sorts_its_points():
    u, windows = stepped([50.0, 10.0], 1.0)
    assert list(stepped_response(windows, u, u, RATE).frequency) == [10.0, 50.0]


def test_noise_lowers_the_coherence_by_its_share_of_the_variance():
    """Sine of amplitude 1 and noise of deviation 0.5: 0.5 / (0.5 + 0.25) = 2/3."""
    u, windows = stepped([20.0], 1.0)
    noise = 0.5 * np.random.default_rng(1).standard_normal(len(u))
    got = stepped_response(windows, u, u + noise, RATE)
    # 5000 samples: the variance of the noise is known to 0.25 sqrt(2/5000) = 5e-3; the
    # amplitude to 0.5 sqrt(2/5000) = 1e-2; three deviations of both
    assert got.coherence[0] == pytest.approx(2.0 / 3.0, abs=3 * 5e-3)
    assert got.gain[0] == pytest.approx(1.0, abs=3e-2)


def sweep(duration: float, low: float, high: float) -> np.ndarray:
    """Return a logarithmic chirp of amplitude 1."""
    t = np.arange(int(duration * RATE)) / RATE
    return signal.chirp(t, low, duration, high, method='logarithmic', phi=-90.0)


def test_chirp_measures_a_second_order_system():
    """w_n = 2 pi 60, zeta = 0.4: gain and phase at all bins."""
    w = 2.0 * math.pi * 60.0
    system = signal.lti([w * w], [1.0, 0.8 * w, w * w])
    u = sweep(40.0, 1.0, 400.0)
    frequencies = np.geomspace(2.0, 300.0, 25)
    got = chirp_response(frequencies, 2.0, u, u, answer(system, u), RATE)
    exact = held(system, got.frequency)
    # The window's autocorrelation 1 - (2/3)(pi tau / T)^2 on the impulse response makes an
    # error of (2/3)(pi / T)^2 |H''|, largest near the resonance: 1/(2 zeta) 2/(zeta w)^2 there.
    # T = 2 s; twice that, because a sweep is not stationary noise.
    bias = 2.0 / 3.0 * (math.pi / 2.0) ** 2 / 0.4 * 1.0 / (0.4 * w) ** 2
    # A logarithmic sweep has a spectrum of 1/f, so that a bin, of variance 1/(3 T^2), has its
    # centre of mass 1/(3 T^2 f) too low. Half as much again for the differences dH/df.
    centre = 1.5 * np.abs(np.gradient(exact, got.frequency)) / (12.0 * got.frequency)
    assert (np.abs(got.value - exact) < 2.0 * bias + centre).all()
    assert 2.0 * bias + centre.max() < 2e-3
    assert got.coherence.min() > 0.999
    # of a chirp of amplitude 1, known by its deviation over a hundred slow cycles and more
    assert got.input_amplitude == pytest.approx(1.0, abs=0.02)
    assert got.output_amplitude == pytest.approx(got.gain * got.input_amplitude, rel=1e-9)


def test_chirp_sees_the_plant_through_a_closed_loop_with_noise():
    """Y/U of a closed loop: S_ry / S_ru is the plant, S_uy / S_uu is biased to -1/controller."""
    r, noise = sweep(40.0, 1.0, 200.0), np.random.default_rng(2).standard_normal(400_000)
    y, u = np.zeros(len(r)), np.zeros(len(r))
    level = 0.0
    for k in range(len(r)):     # y[k] = integral + noise, u = 200 (r - y)
        y[k] = level + 0.3 * noise[k]
        u[k] = 200.0 * (r[k] - y[k])
        level += u[k] / RATE
    got = chirp_response(np.geomspace(3.0, 100.0, 12), 2.0, r, u, y, RATE)
    z = np.exp(2j * math.pi * got.frequency / RATE)
    exact = 1.0 / RATE / (z - 1.0)
    assert got.coherence.min() < 0.95    # the noise has an effect
    # per point sqrt((1 - c) / (2 c n)) for n effective segments of at least 2; four deviations
    # of the magnitude of 1 + plant * controller times the noise over the chirp
    deviation = np.sqrt((1.0 - got.coherence) / (2.0 * got.coherence * 2.0))
    spread = deviation * np.abs(1.0 + 1.0 / (200.0 * exact)) + deviation
    assert (np.abs(got.value / exact - 1.0) < 4.0 * spread).all()


def test_noise_lowers_the_coherence_of_a_chirp():
    u = sweep(20.0, 1.0, 200.0)
    noise = np.random.default_rng(3).standard_normal(len(u))
    frequencies = np.geomspace(5.0, 150.0, 10)
    clean, noisy = (chirp_response(frequencies, 1.0, u, u, u + scale * noise, RATE)
                    for scale in (0.0, 10.0))
    assert clean.coherence.min() > 1.0 - 1e-9
    assert noisy.coherence.max() < 0.99
    assert noisy.coherence.mean() < 0.9


def test_coherence_is_the_share_of_the_power_that_is_explained():
    """
    |S_ry|^2/(S_rr S_yy) = 1/(1 + s^2) of a white signal and white noise of s times its size.

    Of 400 segments side by side, and more that overlap, an estimate scatters by less than
    sqrt(2 c) (1 - c)/sqrt(400) = 0.025; the mean over 40 bins, far enough apart for Hann windows,
    by 0.004. Four deviations: 0.016. Without the square it would be 0.71, 0.45 and 0.95.
    """
    random = np.random.default_rng(5)
    r, noise = random.standard_normal(200_000), random.standard_normal(200_000)
    frequencies = np.linspace(500.0, 4500.0, 40)
    for size, expected in ((1.0, 0.5), (2.0, 0.2), (1.0 / 3.0, 0.9)):
        got = chirp_response(frequencies, 0.05, r, r, r + size * noise, RATE)
        assert got.coherence.mean() == pytest.approx(expected, abs=0.016)


@pytest.mark.parametrize('corner', [3.0, 30.0])
def test_bandwidth_of_a_first_order_lag_is_its_corner(corner):
    got = bandwidth(response_of(first_order(corner), np.geomspace(0.1, 300.0, 60)), dc_gain=1.0)
    # straight lines in dB over log f, points a factor q = 3000^(1/59) apart: at the corner the
    # curvature of 10 log10(1 + w^2) over ln w is 10 log10(e) = 4.34 dB, its slope half of
    # 20 log10(e) = 8.69 dB: off by at most 4.34 / 8 (ln q)^2 / 8.69
    step = math.log(3000.0) / 59.0
    assert got == pytest.approx(corner, rel=4.34 / 8.0 * step * step / 8.69 * 2.0)


def test_bandwidth_is_relative_to_the_lowest_frequency_unless_told():
    """A gain of 5 does not shift it; against dc_gain = 1 it is where 5 / |1 + jw| = 0.707."""
    response = response_of(signal.lti([50.0], [1.0, 10.0]), np.geomspace(0.01, 100.0, 400))
    # as above with ln q = ln(1e4) / 399 = 0.023: below 1e-4
    assert bandwidth(response) == pytest.approx(10.0 / (2.0 * math.pi), rel=1e-4)
    assert bandwidth(response, 1.0) == pytest.approx(7.0 * 10.0 / (2.0 * math.pi), rel=1e-4)


@pytest.mark.parametrize('gains', [
    [5.0, 4.0, 3.0], [5.0, 20.0, 5.0], [6.9, 12.0, 12.0]])
def test_a_gain_that_begins_below_minus_3_db_has_no_bandwidth(gains):
    """Where it fell through 7.07 of 10 is not among the points; a resonance later is another."""
    value = np.array(gains, dtype=complex)
    response = Response(np.array([1.0, 10.0, 100.0]), value, np.ones(3), np.ones(3), value.real)
    assert bandwidth(response, dc_gain=10.0) is None


def test_a_gain_that_never_falls_has_no_bandwidth():
    assert bandwidth(response_of(first_order(1000.0), np.geomspace(1.0, 100.0, 20))) is None


def test_margins_of_a_third_order_loop():
    """L = 4 / (s + 1)^3: phase -180 at sqrt(3) rad/s with |L| = 1/2, |L| = 1 at 1.2328 rad/s."""
    system = signal.lti([4.0], [1.0, 3.0, 3.0, 1.0])
    got = margins(response_of(system, np.geomspace(0.01, 3.0, 300)))
    w = math.sqrt(4.0 ** (2.0 / 3.0) - 1.0)
    # straight lines between points 2 % apart: curvatures below 10 a unit, (0.02)^2 / 8 * 10
    assert got.gain_db == pytest.approx(20.0 * math.log10(2.0), abs=5e-3)
    assert got.gain_frequency == pytest.approx(math.sqrt(3.0) / (2.0 * math.pi), rel=5e-4)
    assert got.phase == pytest.approx(180.0 - 3.0 * math.degrees(math.atan(w)), abs=0.03)
    assert got.phase_frequency == pytest.approx(w / (2.0 * math.pi), rel=5e-4)


def test_an_unstable_loop_has_negative_margins():
    """L = 16 / (s + 1)^3: the gain is twice too large, 6.02 dB."""
    got = margins(response_of(
        signal.lti([16.0], [1.0, 3.0, 3.0, 1.0]), np.geomspace(0.01, 3.0, 300)))
    assert got.gain_db == pytest.approx(-20.0 * math.log10(2.0), abs=5e-3)
    assert got.phase is not None and got.phase < 0.0


def test_an_integrator_has_a_phase_margin_only():
    got = margins(response_of(signal.lti([10.0], [1.0, 0.0]), np.geomspace(0.1, 10.0, 50)))
    assert got.gain_db is None and got.gain_frequency is None
    assert got.phase == pytest.approx(90.0, abs=1e-9)
    # exact: dB over log f is a straight line
    assert got.phase_frequency == pytest.approx(10.0 / (2.0 * math.pi), rel=1e-9)


def test_points_without_coherence_make_no_margin():
    """Noise at the end of the band that jumps over the critical point has no influence."""
    clean = response_of(signal.lti([10.0], [1.0, 0.0]), np.geomspace(0.1, 10.0, 50))
    value, coherence = clean.value.copy(), clean.coherence.copy()
    value[-4:] = [-2.0, 0.1j, -3.0, -0.1j]
    coherence[-4:] = 0.1
    noisy = Response(clean.frequency, value, coherence, clean.gain, clean.gain)
    assert margins(noisy) == margins(clean)


@pytest.mark.parametrize(('frequency', 'expected'), [
    (6000.0, 'frequency = 6000 Hz, must be > 0 and < 5000 Hz'),
    (0.0, 'frequency = 0 Hz'),
    (5.0, '0.1 s of samples have no whole cycle of 5 Hz')])
def test_a_frequency_the_samples_cannot_show_is_refused(frequency, expected):
    with pytest.raises(AnalysisError, match=expected):
        fit_sine(np.zeros(1000), frequency, RATE)


def test_nothing_to_measure_is_refused():
    still, moving = np.zeros(1000), np.sin(np.arange(1000))
    with pytest.raises(AnalysisError, match='without a frequency'):
        stepped_response([], moving, moving, RATE)
    with pytest.raises(AnalysisError, match='the input does not move at 50 Hz'):
        stepped_response([Window(50.0, 0, 1000)], still, moving, RATE)


@pytest.mark.parametrize(('frequencies', 'segment', 'expected'), [
    ([10.0], 0.05, 'hold at least 3 segments'),
    ([], 0.02, 'no frequency from 50 to 5000 Hz'),
    ([6000.0], 0.02, 'no frequency from 50 to 5000 Hz'),
    ([1.0], 0.02, 'no frequency from 50 to 5000 Hz')])
def test_an_empty_band_of_a_chirp_is_refused(frequencies, segment, expected):
    u = sweep(0.1, 100.0, 1000.0)
    with pytest.raises(AnalysisError, match=expected):
        chirp_response(np.array(frequencies), segment, u, u, u, RATE)


def test_a_chirp_that_stands_still_is_refused():
    still = np.zeros(1000)
    with pytest.raises(AnalysisError, match='does not excite'):
        chirp_response(np.array([100.0]), 0.02, still, still, still, RATE)
