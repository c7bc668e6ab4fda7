"""
Friction from a recording: the balance of forces over short windows.

M4 integrated over a window, without contact with a stop,

    int (f_h - F_sensor) dt - I dv = int F_f dt

In steady sliding the bristles of F2 are strained to g(v), so that with the mean speed v of a
window F_f = sgn(v) (F_c + (F_s - F_c) exp(-(v/v_s)^2)) + sigma_2 v  (F1, F3). A constant
force in addition, such as an offset of a sensor, is estimated too. Known: areas and the moving
part's inertia. Left out: windows near the actuator's own stops, with a chamber near a relief,
a refill or the end of its sensor, and with a reversal, a collision or another speed in the
window or shortly before it.
"""

import math

from isa_ros.analysis.identification.estimation import Box, half_widths, Linearised, solve
from isa_ros.analysis.signals.recording import Recording, SHORTEST
from isa_ros.core.frozen import frozen
import numpy as np
from scipy.signal import savgol_filter

WINDOW = 0.020      # s
CORRELATION = 0.4   # s, over which residuals may depend on each other
_SMOOTHED = 0.021   # s, the length of the parabola whose slope is the speed at a window's end
_MARGIN = 1e5       # Pa from relief and return within which a chamber is left out
_NEAR_STOP = 0.01   # of the stroke
_SETTLED = 0.003    # of the stroke, travelled since a reversal or a collision
_SAME_SPEED = 0.3   # change of the speed over that travel, over the speed
_STEADY = 0.5       # change of the speed within a window over its mean
_OUTLIER = 6.0      # robust deviations: a collision within the window
_ROUNDS = 3         # of leaving out outliers
_SHARES = (0.02, 0.5)   # of the windows, slower than the Stribeck speeds tried first
_SPEEDS = 12        # of them
_SLOW_WINDOWS = 10  # slower than the Stribeck speed, in each direction
_SLOW = 0.3         # of the highest speed, above any Stribeck speed

COULOMB, VISCOUS, OFFSET, STICTION, STRIBECK = range(5)
"""Parameters: N, Ns/m, N, N, m/s, or the rotary units."""
N_PARAMETERS = 5
_ALL = np.arange(N_PARAMETERS)
_WITHOUT_SPEED = np.delete(_ALL, STRIBECK)


@frozen
class ForceBalance:
    """
    Estimates and half-widths of the 95 % intervals, (N_PARAMETERS,).

    NaN for a parameter that the data do not determine; then its half-width is infinite.
    """

    values: np.ndarray
    half_widths: np.ndarray


def fit_friction(recording: Recording) -> ForceBalance:
    """
    Return the friction of one actuator.

    The half-widths include, besides the scatter, the rounding of constant pressures and forces,
    and the change of the estimates with windows half as long: a speed that changes too much
    within a window widens them.
    """
    values = np.full(N_PARAMETERS, math.nan)
    widths = np.full(N_PARAMETERS, math.inf)
    if recording.duration < SHORTEST:
        return ForceBalance(values, widths)
    length = round(WINDOW / recording.step)
    windows, shorter = (_ForceWindows(recording, n) for n in (length, length // 2))
    theta = windows.start() if windows.slides_both_ways() else None
    if theta is not None and shorter.slides_both_ways():
        free = _ALL
        theta = windows.solve(theta, free)
        if not windows.shows_stiction(theta):
            free = _WITHOUT_SPEED
            theta = windows.solve(theta, free)
        shorter.leave_out_collisions(theta)
        moved = np.abs(shorter.solve(theta, free) - theta)
        values[free] = theta[free]
        widths[free] = windows.half_widths(theta, free) + moved[free]
        if free is _WITHOUT_SPEED:
            values[STICTION], widths[STICTION] = math.nan, math.inf
    return ForceBalance(values, widths)


class _ForceWindows:
    """The integrals of a recording over windows of ``length`` samples."""

    def __init__(self, recording: Recording, length: int) -> None:
        oil, step = recording.plant.chambers, recording.step
        s = recording.position
        ends = np.arange(0, len(s), length)
        self._stroke = oil.stroke
        duration = length * step
        speed = savgol_filter(s, round(_SMOOTHED / step) | 1, 2, deriv=1, delta=step)
        net = (oil.area_a * recording.pressure_a - oil.area_b * recording.pressure_b
               - recording.force)
        total = np.concatenate([[0.0], np.cumsum(0.5 * step * (net[1:] + net[:-1]))])
        self._travel = np.diff(s[ends])
        self._speed = self._travel / duration
        self._force = (np.diff(total[ends])
                       - recording.plant.mechanics.inertia * np.diff(speed[ends])) / duration
        near = _NEAR_STOP * oil.stroke
        is_free = recording.is_trapped(_MARGIN) & (s > near) & (s < oil.stroke - near)
        is_steady = np.abs(np.diff(speed[ends])) < _STEADY * np.abs(self._speed)
        # A collision affects as many samples as the parabola has.
        is_steady[1:-1] &= is_steady[2:] & is_steady[:-2]
        self._good = recording.is_whole(ends, is_free) & self._is_settled(is_steady)
        rounding = math.hypot(oil.area_a * recording.resolution('pressure_a'),
                              oil.area_b * recording.resolution('pressure_b'),
                              recording.resolution('force')) / math.sqrt(12.0)
        self._rounding = rounding * np.sign(self._speed) * recording.is_standing(
            ends, ('pressure_a', 'pressure_b', 'force'))
        self._lags = round(CORRELATION / duration)

    def _is_settled(self, is_steady: np.ndarray) -> np.ndarray:
        """
        Return the windows in which the bristles have settled.

        The travel before such a window is steady sliding at about the same speed.
        """
        path = np.concatenate([[0.0], np.cumsum(np.abs(self._travel))])
        since = np.maximum.accumulate(np.where(is_steady, 0.0, path[1:]))
        way = _SETTLED * self._stroke
        before = np.searchsorted(path, path[:-1] - way, side='right') - 1
        changed = np.abs(self._speed - self._speed[np.maximum(before, 0)])
        settled: np.ndarray = (is_steady & (path[:-1] - since > way)
                               & (changed < _SAME_SPEED * np.abs(self._speed)))
        return settled

    def slides_both_ways(self) -> bool:
        """Return whether there is sliding in both directions, enough for an interval."""
        least = 2 * self._lags
        speed = self._speed[self._good]
        return bool(np.sum(speed > 0.0) > least and np.sum(speed < 0.0) > least)

    def start(self) -> np.ndarray | None:
        """Return the best fit at some Stribeck speeds without collisions; None: no window."""
        guess = np.zeros(N_PARAMETERS)
        for _ in range(_ROUNDS):
            speed, force = self._speed[self._good], self._force[self._good]
            columns = np.column_stack([np.sign(speed), speed, np.ones_like(speed)])
            linear = np.linalg.lstsq(columns, force, rcond=None)[0]
            self._good[self._good] = np.abs(force - columns @ linear) < abs(linear[0])
            if not self.slides_both_ways():
                return None
        guess[[COULOMB, VISCOUS, OFFSET]] = linear
        guess[STICTION] = guess[COULOMB]
        fits = []
        slow, fast = (float(np.quantile(np.abs(self._speed[self._good]), share))
                      for share in _SHARES)
        for v_s in np.geomspace(slow, fast, _SPEEDS):
            guess[STRIBECK] = v_s
            fits.append(self.solve(guess, _WITHOUT_SPEED))
        best = min(fits, key=lambda fit: float(np.sum(np.abs(self._residuals(fit)))))
        self.leave_out_collisions(best)
        return best

    def solve(self, theta: np.ndarray, free: np.ndarray) -> np.ndarray:
        """Return the parameters with those of ``free`` fitted, the others as in ``theta``."""
        size = np.abs(theta)
        size[OFFSET] = size[COULOMB]
        least, most = np.zeros(N_PARAMETERS), np.full(N_PARAMETERS, math.inf)
        least[VISCOUS], least[OFFSET] = -math.inf, -math.inf
        least[[COULOMB, STICTION]] = 1e-3 * size[COULOMB]
        speeds = np.abs(self._speed[self._good])
        least[STRIBECK], most[STRIBECK] = 1e-3 * speeds.max(), _SLOW * speeds.max()
        box = Box(least[free], most[free], size[free])
        solved = theta.copy()
        solved[free] = solve(lambda some: self._linearised(theta, free, some), theta[free], box)
        return solved

    def half_widths(
            self, theta: np.ndarray, free: np.ndarray, of: np.ndarray | None = None
            ) -> np.ndarray:
        """Return the half-widths of the parameters ``free``, in their order, or of their sums."""
        return half_widths(
            self._linearised(theta, free, theta[free]), np.flatnonzero(self._good), self._lags,
            [self._rounding[self._good]], of)

    def shows_stiction(self, theta: np.ndarray) -> bool:
        """Return whether slow sliding determines stiction and Stribeck speed."""
        speed, v_s = self._speed[self._good], theta[STRIBECK]
        if min(np.sum((0.0 < speed) & (speed < v_s)),
               np.sum((-v_s < speed) & (speed < 0.0))) < _SLOW_WINDOWS:
            return False
        sums = np.zeros((2, N_PARAMETERS))
        sums[0, STICTION], sums[0, COULOMB], sums[1, STRIBECK] = 1.0, -1.0, 1.0
        return bool(np.all(sums @ theta > self.half_widths(theta, _ALL, sums)))

    def leave_out_collisions(self, theta: np.ndarray) -> None:
        """Leave out the windows whose force can only be that of a collision."""
        residuals = self._residuals(theta)
        deviation = 1.4826 * float(np.median(np.abs(residuals)))
        self._good[self._good] = np.abs(residuals) < _OUTLIER * deviation

    def _linearised(
            self, theta: np.ndarray, free: np.ndarray, some: np.ndarray) -> Linearised:
        """Return residuals and derivatives of the good windows."""
        full = theta.copy()
        full[free] = some
        coulomb, viscous, offset, stiction, v_s = full
        speed = self._speed[self._good]
        sign, slow = np.sign(speed), np.exp(-(speed / v_s) ** 2)
        columns = np.column_stack([
            sign * (1.0 - slow), speed, np.ones_like(speed), sign * slow,
            sign * (stiction - coulomb) * slow * 2.0 * speed * speed / (v_s * v_s * v_s)])
        friction = columns[:, :STRIBECK] @ full[:STRIBECK]
        jacobian = columns[:, free]
        return Linearised(self._force[self._good] - friction, jacobian, jacobian)

    def _residuals(self, theta: np.ndarray) -> np.ndarray:
        return self._linearised(theta, _ALL, theta).residuals
