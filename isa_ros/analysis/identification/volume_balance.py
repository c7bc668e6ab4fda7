"""
Valve and oil from a recording: the volume balance of both chambers over short windows.

C2 integrated over a window,

    A_A ds = int Q_A dt - 1/beta int V_A dP_A - C_li int (P_A - P_B) dt
   -A_B ds = int Q_B dt - 1/beta int V_B dP_B + C_li int (P_A - P_B) dt

is linear in 1/beta and C_li, and with V6, V7 and V14 for the flows in q_0 and in most of the
flow curve's parameters. No signal is differentiated. The null of the lands on the spool's
sensor is estimated too. Known: areas, dead volume, land factors, lap, dp_ref, delta and x_l.
Left out: windows in which a chamber is near a relief, a refill or the end of its sensor.
"""

from collections.abc import Sequence
import math
from typing import NamedTuple

from isa_ros.analysis.identification.estimation import Box, half_widths, Linearised, solve
from isa_ros.analysis.identification.flow_curves import FlowCurve
from isa_ros.analysis.signals.recording import Recording, SHORTEST
from isa_ros.core.frozen import frozen
import numpy as np
from scipy.interpolate import CubicSpline

WINDOW = 0.010      # s, short for the motion, long for the noise of its two ends
CORRELATION = 0.4   # s, over which residuals may depend on each other
_SUBSTEPS = 4       # of a sample, between which spool and pressures are interpolated
_ROUNDING = 1.0 / math.sqrt(12.0)   # standard deviation of a rounding over its step
_MARGIN = 1e5       # Pa from relief and return within which a chamber is left out

NULL, Q_0, COMPLIANCE, C_LI, CURVE = range(5)
"""Parameters: m, m3/s, 1/Pa, m3/s/Pa, and the first of the flow curve's own."""
_LINEAR = (Q_0, COMPLIANCE, C_LI)


@frozen
class Balance:
    """
    Estimates and half-widths of the 95 % intervals, (CURVE + curve.size,).

    NaN for a parameter that the recording does not excite; then its half-width is infinite.
    """

    values: np.ndarray
    half_widths: np.ndarray
    duration: float
    """Of all windows in use, s."""


class _Land(NamedTuple):
    """One land: its opening at null, its sign of opening, and S(dP)/sqrt(dp_ref) f."""

    closed_by: float
    direction: float
    weight: np.ndarray


def fit_balance(recording: Recording, curve: FlowCurve) -> Balance:
    """
    Return the valve's and the oil's parameters of one actuator.

    The half-widths include, besides the scatter, the rounding of a spool at rest, and the
    change of the estimates at half the rate: motion too fast for the sampling widens them.
    """
    if recording.duration < SHORTEST:
        size = CURVE + curve.size
        return Balance(np.full(size, math.nan), np.full(size, math.inf), 0.0)
    windows = _VolumeWindows(recording, curve, round(WINDOW / recording.step))
    values, widths = _fit(windows)
    slower = recording.half_rate()
    coarse, _ = _fit(_VolumeWindows(slower, curve, round(WINDOW / slower.step)))
    moved = np.abs(coarse - values)
    widths = widths + np.where(np.isfinite(moved), moved, math.inf)
    return Balance(values, widths, windows.n_good * WINDOW)


def _fit(windows: '_VolumeWindows') -> tuple[np.ndarray, np.ndarray]:
    values = np.full(windows.size, math.nan)
    widths = np.full(windows.size, math.inf)
    free = windows.excited()
    if windows.n_good <= len(free):
        return values, widths
    start = windows.start()

    def model(theta: np.ndarray) -> Linearised:
        full = start.copy()
        full[free] = theta
        return windows.linearised(full, free)

    theta = solve(model, start[free], windows.box(start, free))
    values[free] = theta
    lags = round(CORRELATION / WINDOW)
    full = start.copy()
    full[free] = theta
    widths[free] = half_widths(
        model(theta), windows.groups, lags, windows.rounding(full))
    return values, widths


class _VolumeWindows:
    """The integrals of a recording over windows of ``length`` samples, both chambers."""

    def __init__(self, recording: Recording, curve: FlowCurve, length: int) -> None:
        self._curve = curve
        self.size = CURVE + curve.size
        self._x_l = recording.plant.valve.x_l
        self._step = recording.step / _SUBSTEPS
        self._ends = np.arange(0, len(recording.position), length)
        self._good = recording.is_whole(self._ends, recording.is_trapped(_MARGIN))
        self.n_good = int(np.count_nonzero(self._good))
        self.groups = np.tile(np.flatnonzero(self._good), 2)
        standing = recording.is_standing(self._ends, ('spool',))
        self._rounding = _ROUNDING * recording.resolution('spool') * np.append(
            np.repeat(standing, length * _SUBSTEPS), np.zeros(
                (len(recording.position) - 1 - self._ends[-1]) * _SUBSTEPS + 1))
        self._spool, p_a, p_b = (_fine(signal) for signal in (
            recording.spool, recording.pressure_a, recording.pressure_b))
        self._travel = np.abs(self._spool)
        self._lands = _lands(recording, p_a, p_b)
        oil, s = recording.plant.chambers, recording.position
        moved = np.diff(s[self._ends])[self._good]
        self._displaced = np.concatenate([oil.area_a * moved, -oil.area_b * moved])
        volumes = (oil.dead_volume + oil.area_a * s,
                   oil.dead_volume + oil.area_b * (oil.stroke - s))
        pressures = recording.pressure_a, recording.pressure_b
        self._compressed = np.concatenate([
            self._taken_up(v, p) for v, p in zip(volumes, pressures)])
        self._instrument = np.concatenate([
            self._taken_up(v, _from_neighbours(p)) for v, p in zip(volumes, pressures)])
        across = self._integral(p_a - p_b)
        self._across = np.concatenate([across, -across])

    def _integral(self, signal: np.ndarray) -> np.ndarray:
        """Return the integral of a fine signal over each good window, (n_good,)."""
        total = np.concatenate([[0.0], np.cumsum(0.5 * self._step * (signal[1:] + signal[:-1]))])
        integral: np.ndarray = np.diff(total[self._ends * _SUBSTEPS])[self._good]
        return integral

    def _taken_up(self, volume: np.ndarray, pressure: np.ndarray) -> np.ndarray:
        """Return int V dP over each good window, (n_good,)."""
        part = 0.5 * (volume[1:] + volume[:-1]) * np.diff(pressure)
        total = np.concatenate([[0.0], np.cumsum(part)])
        taken: np.ndarray = np.diff(total[self._ends])[self._good]
        return taken

    def _through(self, shapes: Sequence[np.ndarray]) -> np.ndarray:
        """Return the integral of the lands' flows, given g or a derivative of each."""
        return np.concatenate([
            self._integral(sum(land.weight * shape for land, shape in zip(lands, pair)))
            for lands, pair in zip(self._lands, (shapes[:2], shapes[2:]))])

    def _openings(self, null: float) -> list[np.ndarray]:
        return [land.direction * (self._spool - null) - land.closed_by
                for lands in self._lands for land in lands]

    def excited(self) -> np.ndarray:
        """Return the parameters that the recording excites."""
        curve = [CURVE + k for k in self._curve.excited(self._travel)]
        return np.array([NULL, *_LINEAR, *curve])

    def box(self, start: np.ndarray, free: np.ndarray) -> Box:
        """Return the bounds of the parameters ``free``."""
        travel = float(np.max(self._travel))
        least, most = np.full(self.size, -math.inf), np.full(self.size, math.inf)
        least[NULL], most[NULL] = -0.5 * travel, 0.5 * travel
        least[CURVE:], most[CURVE:] = self._curve.bounds(self._travel)
        size = np.abs(start)
        size[NULL] = travel
        size[Q_0] = max(size[Q_0], 1e-3 * travel * size[CURVE])
        return Box(least[free], most[free], size[free])

    def start(self) -> np.ndarray:
        """Return the linear least-squares estimates at the best guess of the flow curve."""
        openings = self._openings(0.0)
        shared = [self._through([self._leaking(u) for u in openings]),
                  -self._compressed, -self._across]
        best, least = np.zeros(self.size), math.inf
        for bend in self._curve.guesses(self._travel):
            shapes = zip(*(self._curve.shapes(u, bend) for u in openings))
            columns = np.column_stack([*shared, *map(self._through, shapes)])
            scale = np.linalg.norm(columns, axis=0)
            scale[scale == 0.0] = 1.0
            factors = np.linalg.lstsq(columns / scale, self._displaced, rcond=None)[0] / scale
            error = float(np.sum((columns @ factors - self._displaced) ** 2))
            if error < least:
                least = error
                best = np.array([0.0, *factors[:3], *self._curve.theta(factors[3:], bend)])
        return best

    def _leaking(self, u: np.ndarray) -> np.ndarray:
        """Return the leakage of a land per unit of q_0  (V6)."""
        leaking: np.ndarray = self._x_l / (self._x_l + np.abs(u))
        return leaking

    def _slopes(self, theta: np.ndarray) -> list[np.ndarray]:
        """Return the change of the lands' flows per m of spool."""
        directions = [land.direction for lands in self._lands for land in lands]
        return [d * (self._curve.slope(u, theta[CURVE:])
                     - np.sign(u) * theta[Q_0] * self._leaking(u) / (self._x_l + np.abs(u)))
                for d, u in zip(directions, self._openings(theta[NULL]))]

    def rounding(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the effect of a resting spool's rounding, all one way or away from null."""
        slopes = self._slopes(theta)
        away = np.sign(self._spool)
        return (self._through([self._rounding * slope for slope in slopes]),
                self._through([self._rounding * away * slope for slope in slopes]))

    def linearised(self, theta: np.ndarray, free: np.ndarray) -> Linearised:
        """Return the balance's residuals and the derivatives to the parameters ``free``."""
        own, openings = theta[CURVE:], self._openings(theta[NULL])
        leaking = [self._leaking(u) for u in openings]
        columns = {Q_0: self._through(leaking), COMPLIANCE: -self._compressed,
                   C_LI: -self._across}
        passed = self._through([self._curve.flow(u, own) for u in openings])
        residuals = self._displaced - passed - sum(
            theta[k] * column for k, column in columns.items())
        columns[NULL] = -self._through(self._slopes(theta))
        for k in free[free >= CURVE]:
            columns[k] = self._through([
                self._curve.derivative(u, own, k - CURVE) for u in openings])
        jacobian = np.column_stack([columns[k] for k in free])
        instruments = jacobian.copy()
        instruments[:, np.flatnonzero(free == COMPLIANCE)[0]] = -self._instrument
        return Linearised(residuals, jacobian, instruments)


def _lands(
        recording: Recording, p_a: np.ndarray, p_b: np.ndarray
        ) -> tuple[tuple[_Land, _Land], tuple[_Land, _Land]]:
    """Return the lands of chambers A and B at fine samples, flows into them positive  (V7)."""
    valve, p_t = recording.plant.valve, recording.return_pressure
    # The supply pressure of a sample is in force until the next one.
    p_s = np.repeat(recording.supply_pressure, _SUBSTEPS)[:len(p_a)]

    def root(dp: np.ndarray) -> np.ndarray:
        flow: np.ndarray = valve.per_root_drop * dp / np.sqrt(np.hypot(dp, valve.delta))
        return flow
    return ((_Land(valve.lap_pa, 1.0, valve.f_pa * root(p_s - p_a)),
             _Land(valve.lap_at, -1.0, -valve.f_at * root(p_a - p_t))),
            (_Land(valve.lap_bt, 1.0, -valve.f_bt * root(p_b - p_t)),
             _Land(valve.lap_pb, -1.0, valve.f_pb * root(p_s - p_b))))


def _fine(signal: np.ndarray) -> np.ndarray:
    """Return a signal at the samples and between them, by a cubic spline."""
    n = len(signal)
    fine: np.ndarray = CubicSpline(np.arange(n), signal)(
        np.arange((n - 1) * _SUBSTEPS + 1) / _SUBSTEPS)
    return fine


def _from_neighbours(signal: np.ndarray) -> np.ndarray:
    """Return for every sample the value of the cubic through its four neighbours."""
    filled = signal.copy()
    filled[2:-2] = (4.0 * (signal[1:-3] + signal[3:-1]) - signal[:-4] - signal[4:]) / 6.0
    return filled
