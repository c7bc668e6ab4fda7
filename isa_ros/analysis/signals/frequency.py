"""
Frequency response of sampled signals: stepped sine and chirp, bandwidth, margins.

Independent of the plant: signals are arrays of equal length, sampled at ``rate`` (Hz).
Amplitudes are peak values in the signals' own units. A response from ``x`` to ``y`` is computed
with the excitation ``r``, as (y over r) divided by (x over r): inside a closed loop the plain
ratio of spectra would be biased by noise that the controller feeds back.
"""

from collections.abc import Sequence
from dataclasses import fields
import math
from typing import NamedTuple

from isa_ros.core.frozen import frozen
from isa_ros.errors import AnalysisError
import numpy as np

HALF_POWER = 1.0 / math.sqrt(2.0)   # -3.01 dB
TRUSTED = 0.8        # least coherence of a point that counts: the rest has half the size
SEGMENTS = 3         # least whole segments of a chirp: one alone is always coherent


@frozen
class Response:
    """
    A frequency response, each array of shape (n,), frequencies ascending.

    ``coherence`` is the share of the output's variance that the response explains, 0 to 1.
    """

    frequency: np.ndarray           # Hz
    value: np.ndarray               # complex, unit of the output per unit of the input
    coherence: np.ndarray
    input_amplitude: np.ndarray
    output_amplitude: np.ndarray

    @property
    def gain(self) -> np.ndarray:
        """Return |value|."""
        gain: np.ndarray = np.abs(self.value)
        return gain

    @property
    def gain_db(self) -> np.ndarray:
        """Return 20 log10 of the gain; -inf where it is zero."""
        with np.errstate(divide='ignore'):
            decibels: np.ndarray = 20.0 * np.log10(self.gain)
        return decibels

    @property
    def phase(self) -> np.ndarray:
        """Return the phase in degrees, continuous from the lowest frequency on."""
        phase: np.ndarray = np.degrees(np.unwrap(np.angle(self.value)))
        return phase

    @property
    def is_trusted(self) -> np.ndarray:
        """Return for each point whether its coherence is at least `TRUSTED`."""
        found: np.ndarray = self.coherence >= TRUSTED
        return found

    @property
    def trusted(self) -> 'Response':
        """Return the points that are trusted."""
        kept = self.is_trusted
        return Response(*(getattr(self, f.name)[kept] for f in fields(self)))


class FittedSine(NamedTuple):
    """A sine fitted to a signal: real part of ``amplitude`` exp(j 2 pi f t), and the rest."""

    amplitude: complex
    offset: float
    explained: float
    """Share of the variance that the sine explains; 0 for a constant signal."""


def fit_sine(values: np.ndarray, frequency: float, rate: float) -> FittedSine:
    """
    Fit sine, cosine and offset at ``frequency`` by least squares.

    Only the last whole cycles are used: over them the three are orthogonal, so that offsets and
    harmonics have no influence.

    Raises
    ------
    AnalysisError
        Less than one cycle, or the frequency is not below half the rate.

    """
    if not 0.0 < frequency < 0.5 * rate:
        raise AnalysisError(
            f'frequency = {frequency:g} Hz, must be > 0 and < {0.5 * rate:g} Hz, half the '
            'rate of the samples')
    cycles = math.floor(len(values) * frequency / rate + 1e-9)
    if cycles < 1:
        raise AnalysisError(
            f'{len(values) / rate:g} s of samples have no whole cycle of {frequency:g} Hz')
    n = round(cycles * rate / frequency)
    angle = 2.0 * math.pi * frequency / rate * np.arange(len(values) - n, len(values))
    basis = np.column_stack((np.cos(angle), np.sin(angle), np.ones(n)))
    window = np.asarray(values[-n:], dtype=float)
    parts = np.linalg.lstsq(basis, window, rcond=None)[0]
    variance = float(np.var(window))
    # A constant signal is one value up to the rounding of its mean.
    if variance <= np.square(4.0 * np.finfo(float).eps * np.abs(window).max()):
        return FittedSine(0j, float(parts[2]), 0.0)
    left = float(np.var(window - basis @ parts)) / variance
    return FittedSine(complex(parts[0], -parts[1]), float(parts[2]), max(0.0, 1.0 - left))


class Window(NamedTuple):
    """The samples of a stepped sine that belong to one frequency, settled."""

    frequency: float
    start: int
    end: int


def stepped_response(
        windows: Sequence[Window], x: np.ndarray, y: np.ndarray, rate: float) -> Response:
    """
    Return the response from ``x`` to ``y``, one point for each window of a stepped sine.

    The coherence is the share of the output's variance at the frequency itself: harmonics,
    noise and drift lower it.

    Raises
    ------
    AnalysisError
        No window is given, or the input does not contain the frequency.

    """
    if not windows:
        raise AnalysisError('a stepped sine without a frequency, must have at least one')
    rows = []
    for frequency, start, end in windows:
        into, out = (fit_sine(s[start:end], frequency, rate) for s in (x, y))
        if into.amplitude == 0j:
            raise AnalysisError(f'the input does not move at {frequency:g} Hz')
        rows.append((frequency, out.amplitude / into.amplitude, out.explained,
                     abs(into.amplitude), abs(out.amplitude)))
    columns = [np.array(column) for column in zip(*rows)]
    return Response(*(column[np.argsort(columns[0])] for column in columns))


def chirp_response(
        frequencies: np.ndarray, segment: float, r: np.ndarray, x: np.ndarray, y: np.ndarray,
        rate: float) -> Response:
    """
    Return the response from ``x`` to ``y`` to a chirp ``r`` of constant amplitude.

    Spectra are averaged over Hann windows of ``segment`` seconds (Welch), three quarters
    overlapping: then their squares add up to a constant and all instants of the sweep have the
    same weight. The value is S_ry / S_rx at the bins nearest to ``frequencies``, the coherence
    |S_ry|^2 / (S_rr S_yy). Amplitudes are those for a sine with the chirp's amplitude.

    Raises
    ------
    AnalysisError
        Too short for `SEGMENTS` segments, no bin in the band, or no excitation there.

    """
    n = round(segment * rate)
    if n < 2 or len(r) < SEGMENTS * n:
        raise AnalysisError(
            f'{len(r) / rate:g} s of a chirp in segments of {segment:g} s, must hold at '
            f'least {SEGMENTS} segments')

    from scipy.signal import csd    # half a second, which sines do not need

    def spectrum(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        found: np.ndarray = csd(a, b, fs=rate, nperseg=n, noverlap=n - n // 4)[1]
        return found
    bins = np.unique(np.round(np.asarray(frequencies) * n / rate).astype(int))
    bins = bins[(bins >= 1) & (bins < n // 2)]
    if not len(bins):
        raise AnalysisError(
            f'no frequency from {rate / n:g} to {0.5 * rate:g} Hz, the band that segments '
            f'of {segment:g} s resolve')
    rr, yy = spectrum(r, r)[bins].real, spectrum(y, y)[bins].real
    rx, ry = spectrum(r, x)[bins], spectrum(r, y)[bins]
    if not (rr > 0.0).all() or not np.abs(rx).all():
        raise AnalysisError('the chirp does not excite the whole band')
    amplitude = math.sqrt(2.0) * float(np.std(r))
    with np.errstate(invalid='ignore'):
        coherence = np.where(yy > 0.0, np.square(np.abs(ry)) / (rr * yy), 0.0)
    return Response(
        bins * rate / n, ry / rx, coherence,
        amplitude * np.abs(rx) / rr, amplitude * np.abs(ry) / rr)


def bandwidth(response: Response, dc_gain: float | None = None) -> float | None:
    """
    Return the frequency at which the gain first falls through -3 dB of ``dc_gain``, in Hz.

    None as ``dc_gain`` means the gain at the lowest frequency. Interpolated in dB over log f
    between the two points around it; None if the gain never falls there. Points that are not
    trusted are left out.
    """
    kept = response.trusted
    if not len(kept.frequency):
        return None
    level = (float(kept.gain[0]) if dc_gain is None else dc_gain) * HALF_POWER
    below = np.flatnonzero(kept.gain < level)
    if not len(below) or below[0] == 0:
        return None
    k = int(below[0])
    return _crossing(kept.frequency, kept.gain_db - 20.0 * math.log10(level), k)


class Margins(NamedTuple):
    """Stability margins of an open loop; None where it never crosses."""

    gain_db: float | None
    gain_frequency: float | None     # Hz, where the phase is -180 deg
    phase: float | None              # deg
    phase_frequency: float | None    # Hz, where the gain is 1


def margins(response: Response) -> Margins:
    """
    Return the smallest gain and phase margins of an open loop L of 1/(1 + L).

    Of several crossings the one closest to instability is used. Points that are not trusted are
    left out.
    """
    frequency, value = response.trusted.frequency, response.trusted.value
    gains, phases = [], []
    with np.errstate(divide='ignore'):
        level = 20.0 * np.log10(np.abs(value))
    angle = np.unwrap(np.angle(value))
    turns = np.floor((angle + math.pi) / (2.0 * math.pi))
    for k in _changes(level > 0.0):
        at = _crossing(frequency, level, k)
        phase = math.degrees(_between(frequency, angle, k, at))
        phases.append(((phase + 360.0) % 360.0 - 180.0, at))
    for k in _changes(turns):
        limit = 2.0 * math.pi * max(turns[k - 1:k + 1].tolist()) - math.pi
        at = _crossing(frequency, angle - limit, k)
        gains.append((-_between(frequency, level, k, at), at))
    gain = min(gains, key=lambda margin: abs(margin[0]), default=(None, None))
    phase_margin = min(phases, key=lambda margin: abs(margin[0]), default=(None, None))
    return Margins(*gain, *phase_margin)


def _changes(values: np.ndarray) -> list[int]:
    """Return the points whose value is not that of the one before."""
    found: list[int] = (np.flatnonzero(values[1:] != values[:-1]) + 1).tolist()
    return found


def _crossing(frequency: np.ndarray, values: np.ndarray, k: int) -> float:
    """Return where ``values`` pass zero between points k - 1 and k, linear over log f."""
    left, right = float(values[k - 1]), float(values[k])
    if not math.isfinite(right):     # a gain of zero has no dB to interpolate to
        return float(frequency[k])
    share = left / (left - right)
    return float(frequency[k - 1] * (frequency[k] / frequency[k - 1]) ** share)


def _between(frequency: np.ndarray, values: np.ndarray, k: int, at: float) -> float:
    logs = np.log(frequency[k - 1:k + 1])
    return float(np.interp(math.log(at), logs, values[k - 1:k + 1]))


def ripple(values: np.ndarray) -> float:
    """Return the ripple of a signal that should stand still: half of peak to peak."""
    return 0.5 * float(np.ptp(values))


def ripple_frequency(values: np.ndarray, rate: float) -> float:
    """Return the frequency of a ripple: of the largest peak without the drift, in Hz."""
    from scipy.signal import detrend
    from scipy.signal.windows import hann
    found = np.abs(np.fft.rfft(hann(len(values), sym=False) * detrend(values)))
    return float((1 + int(np.argmax(found[1:]))) * rate / len(values))
