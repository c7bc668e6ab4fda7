"""
Excitation for frequency responses: one sine after another, or a chirp.

Excitations have amplitude 1. The frequencies of the stepped sine are changed slightly, so that
the measured cycles fill whole periods of a grid: then the samples of a tick, and the images of a
reference held over a tick, are orthogonal to the sine.
"""

import math
from typing import NamedTuple

from isa_ros.analysis.signals.frequency import chirp_response, Response, stepped_response, Window
from isa_ros.core.frozen import frozen
from isa_ros.errors import ConfigError
import numpy as np

GRID_S = 1e-3       # default grid: ten periods of the trace
SETTLE_S = 0.2      # least settling time at each frequency
SETTLE_CYCLES = 1   # least settling cycles at each frequency
WINDOW_S = 0.2      # least measured time at each frequency
WINDOW_CYCLES = 4   # least measured cycles at each frequency
SEGMENT_CYCLES = 4  # cycles of the lowest frequency in a segment of a chirp
LEAST_SEGMENT_S = 0.5
SEGMENTS = 16       # number of segments of a chirp
EDGE = 1.25         # factor by which a chirp exceeds its band at both ends
LARGEST_SHARE = 0.4     # highest frequency over the rate at which a loop samples its reference
TWO_PI = 2.0 * math.pi


@frozen(kw_only=True)
class FrequencySweep:
    """Frequencies of a measurement, Hz, and the kind of excitation."""

    low: float
    high: float
    points: int
    is_chirp: bool = False

    @property
    def frequencies(self) -> np.ndarray:
        """Return the wanted frequencies: ``points`` of them, equally spaced in log f."""
        return np.geomspace(self.low, self.high, self.points)

    def check(self, rate: float, what: str) -> None:
        """
        Refuse an empty band, and one that is too high for ``rate`` references per second.

        Raises
        ------
        ConfigError
            The band is refused; ``what`` describes the rate in the message.

        """
        if not 0.0 < self.low < self.high:
            raise ConfigError(
                f'--from = {self.low:g} Hz, must be < --to = {self.high:g} Hz and > 0')
        if self.points < 2:
            raise ConfigError(f'--points = {self.points}, must be >= 2')
        if self.high > LARGEST_SHARE * rate:
            raise ConfigError(
                f'--to = {self.high:g} Hz, must be <= {LARGEST_SHARE * rate:g} Hz: {what} at '
                f'{rate:g} Hz')


class SineSection(NamedTuple):
    """One frequency of a stepped sine, and its times in s: whole periods of the grid."""

    frequency: float
    settle: float
    measured: float


def sections(sweep: FrequencySweep, grid: float) -> tuple[SineSection, ...]:
    """Return the sections of a stepped sine, times in multiples of ``grid`` (s)."""
    found = []
    for wanted in sweep.frequencies:
        cycles = max(WINDOW_CYCLES, math.ceil(WINDOW_S * wanted))
        measured = round(cycles / wanted / grid) * grid
        frequency = cycles / measured
        settle = math.ceil(max(SETTLE_S, SETTLE_CYCLES / frequency) / grid) * grid
        found.append(SineSection(float(frequency), settle, measured))
    return tuple(found)


def windows(parts: tuple[SineSection, ...], rate: float, first: int) -> tuple[Window, ...]:
    """Return the windows of the settled samples; the first section begins at row ``first``."""
    found, at = [], first
    for frequency, settle, measured in parts:
        start = at + round(settle * rate)
        at = start + round(measured * rate)
        found.append(Window(frequency, start, at))
    return tuple(found)


class ChirpBand(NamedTuple):
    """A logarithmic chirp; its spectra are averaged over segments."""

    low: float
    high: float
    duration: float
    segment: float


def chirp_band(sweep: FrequencySweep, rate: float, grid: float) -> ChirpBand:
    """Return the chirp of a sweep: slightly more than its band, up to half the rate."""
    segment = math.ceil(max(LEAST_SEGMENT_S, SEGMENT_CYCLES / sweep.low) / grid) * grid
    return ChirpBand(
        sweep.low / EDGE, min(EDGE * sweep.high, 0.5 * rate), SEGMENTS * segment, segment)


@frozen
class Estimator:
    """Estimator of the response from the samples of a run."""

    rate: float
    windows: tuple[Window, ...] = ()    # of a stepped sine; empty for a chirp
    segment: float = 0.0                # length of a segment of a chirp, s
    frequencies: np.ndarray | None = None

    def estimate(self, r: np.ndarray, x: np.ndarray, y: np.ndarray) -> Response:
        """Return the response from ``x`` to ``y`` under the reference ``r``, each (n,)."""
        if self.frequencies is None:
            return stepped_response(self.windows, x, y, self.rate)
        return chirp_response(self.frequencies, self.segment, r, x, y, self.rate)


class Excitation(NamedTuple):
    """Values of amplitude 1, their rates of change (1/s), and the estimator of the response."""

    values: np.ndarray
    rates: np.ndarray
    answer: Estimator


def excitation(sweep: FrequencySweep, rate: float) -> Excitation:
    """Return the excitation of a sweep, with ``rate`` values per second."""
    return (_chirp if sweep.is_chirp else _stepped)(sweep, rate)


def _stepped(sweep: FrequencySweep, rate: float) -> Excitation:
    """Return one sine after another, continuous in phase."""
    phases, slopes, phase = [], [], 0.0
    parts = sections(sweep, GRID_S)
    for frequency, settle, measured in parts:
        n = round((settle + measured) * rate)
        slope = TWO_PI * frequency
        phases.append(phase + slope / rate * np.arange(n))
        slopes.append(np.full(n, slope))
        phase = math.fmod(phase + slope / rate * n, TWO_PI)
    angle = np.concatenate(phases)
    return Excitation(
        np.sin(angle), np.concatenate(slopes) * np.cos(angle),
        Estimator(rate, windows(parts, rate, 0)))


def _chirp(sweep: FrequencySweep, rate: float) -> Excitation:
    """Return f = f_0 (f_1/f_0)^(t/T)."""
    band = chirp_band(sweep, rate, GRID_S)
    t = np.arange(round(band.duration * rate)) / rate
    growth = math.log(band.high / band.low) / band.duration
    angle = TWO_PI * band.low * np.expm1(growth * t) / growth
    slope = TWO_PI * band.low * np.exp(growth * t)
    return Excitation(
        np.sin(angle), slope * np.cos(angle),
        Estimator(rate, segment=band.segment, frequencies=sweep.frequencies))
