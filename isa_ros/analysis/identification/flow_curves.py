"""
The flow curve g of V4 for identification: values, slopes and derivatives.

It is the flow of a land at the reference drop over its opening u, in m, > 0 for an open land, and
0 for u <= 0. ``theta``, (size,), are the curve's own parameters. Each curve gives g (`flow`,
m3/s), dg/du (`slope`, m2/s) and dg/dtheta_k (`derivative`); for the first fit candidates
of its bend (`guesses`), the shapes of which g with that bend is a linear combination (`shapes`),
and the parameters of their factors (`theta`). `excited` are the parameters that a spool with this
travel, (n,), excites, `bounds` the least and greatest ones, (size,) each.
"""

import math

import numpy as np

_SHARES = np.linspace(0.05, 0.95, 13)   # of the spool's travels, tried as x_dg
_BENDS = np.geomspace(0.1, 10.0, 9)     # over the knee, tried as k_low/q_rest
_LEAST = 0.01                           # share of the samples that excites a parameter


class DualGainCurve:
    """Parameters k_low, k_high (m2/s) and x_dg (m), with ``x_dg`` as first guess of the last."""

    size = 3

    def __init__(self, x_dg: float) -> None:
        self._x_dg = x_dg

    def flow(self, u: np.ndarray, theta: np.ndarray) -> np.ndarray:
        """Return k_low u up to x_dg, beyond with slope k_high  (V4)."""
        flow: np.ndarray = (theta[0] * _first(u, theta[2]) + theta[1] * _beyond(u, theta[2]))
        return flow

    def slope(self, u: np.ndarray, theta: np.ndarray) -> np.ndarray:
        """Return k_low or k_high where the land is open."""
        slope: np.ndarray = np.where(u > theta[2], theta[1], theta[0]) * (u > 0.0)
        return slope

    def derivative(self, u: np.ndarray, theta: np.ndarray, k: int) -> np.ndarray:
        """Return dg/dtheta_k."""
        derivatives: tuple[np.ndarray, ...] = (
            _first(u, theta[2]), _beyond(u, theta[2]), (theta[0] - theta[1]) * (u > theta[2]))
        return derivatives[k]

    def guesses(self, travel: np.ndarray) -> list[float]:
        """Return x_dg at some shares of the travel."""
        if len(self.excited(travel)) == 1:
            return [math.inf]
        return [float(x_dg) for x_dg in np.quantile(travel, _SHARES)]

    def shapes(self, u: np.ndarray, bend: float) -> list[np.ndarray]:
        """Return the opening up to x_dg and the opening beyond it."""
        if math.isinf(bend):
            return [_first(u, bend)]
        return [_first(u, bend), _beyond(u, bend)]

    def theta(self, factors: np.ndarray, bend: float) -> np.ndarray:
        """Return the slopes and x_dg."""
        return np.array([factors[0], factors[-1], bend])

    def excited(self, travel: np.ndarray) -> list[int]:
        """Leave out the parameters that a spool near null does not excite."""
        is_beyond = np.count_nonzero(travel > self._x_dg) > _LEAST * len(travel)
        return [0, 1, 2] if is_beyond else [0]

    def bounds(self, travel: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Keep x_dg within the travel."""
        if len(self.excited(travel)) == 1:
            return np.full(3, -math.inf), np.full(3, math.inf)
        most = float(np.max(travel))
        return (np.array([-math.inf, -math.inf, 0.02 * most]),
                np.array([math.inf, math.inf, 0.98 * most]))


class HighResponseCurve:
    """Parameters k_low (m2/s) and q_rest (m3/s); the ``knee`` (m) is known."""

    size = 2

    def __init__(self, knee: float) -> None:
        self._knee = knee

    def flow(self, u: np.ndarray, theta: np.ndarray) -> np.ndarray:
        """Return k_low u up to the knee, beyond it the exponential rise by q_rest  (V4)."""
        left = self._left(u, theta)
        flow: np.ndarray = theta[0] * _first(u, self._knee) + theta[1] * (1.0 - left)
        return flow

    def slope(self, u: np.ndarray, theta: np.ndarray) -> np.ndarray:
        """Return k_low, fading beyond the knee, where the land is open."""
        slope: np.ndarray = theta[0] * self._left(u, theta) * (u > 0.0)
        return slope

    def derivative(self, u: np.ndarray, theta: np.ndarray, k: int) -> np.ndarray:
        """Return dg/dtheta_k."""
        left, beyond = self._left(u, theta), _beyond(u, self._knee)
        derivatives: tuple[np.ndarray, ...] = (
            _first(u, self._knee) + left * beyond,
            1.0 - left - left * beyond * theta[0] / theta[1])
        return derivatives[k]

    def guesses(self, travel: np.ndarray) -> list[float]:
        """Return some k_low/q_rest, 1/m."""
        return [float(bend) for bend in _BENDS / self._knee]

    def shapes(self, u: np.ndarray, bend: float) -> list[np.ndarray]:
        """Return the curve with k_low = 1."""
        return [_first(u, self._knee) - np.expm1(-bend * _beyond(u, self._knee)) / bend]

    def theta(self, factors: np.ndarray, bend: float) -> np.ndarray:
        """Return k_low and q_rest."""
        return np.array([factors[0], factors[0] / bend])

    def excited(self, travel: np.ndarray) -> list[int]:
        """Leave out the parameter that a spool below the knee does not excite."""
        is_beyond = np.count_nonzero(travel > self._knee) > _LEAST * len(travel)
        return [0, 1] if is_beyond else [0]

    def bounds(self, travel: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Keep both positive."""
        return np.array([0.0, 1e-12]), np.full(2, math.inf)

    def _left(self, u: np.ndarray, theta: np.ndarray) -> np.ndarray:
        left: np.ndarray = np.exp(-_beyond(u, self._knee) * theta[0] / theta[1])
        return left


def _first(u: np.ndarray, x: float) -> np.ndarray:
    first: np.ndarray = np.clip(u, 0.0, x)
    return first


def _beyond(u: np.ndarray, x: float) -> np.ndarray:
    beyond: np.ndarray = np.maximum(u, x) - x if math.isfinite(x) else np.zeros_like(u)
    return beyond


FlowCurve = DualGainCurve | HighResponseCurve
