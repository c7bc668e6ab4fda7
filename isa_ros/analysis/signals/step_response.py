"""
Figures of a step response: rise, overshoot, settling, steady error; independent of the plant.

All figures are relative to the commanded change ``target - start``, of either sign, so that a
steady error affects every figure.
"""

from typing import NamedTuple

from isa_ros.errors import AnalysisError
import numpy as np

RISE = (0.1, 0.9)    # between these shares of the change
TAIL = 0.1           # of the recording: its end, over which the steady state is averaged


class StepFigures(NamedTuple):
    """The figures of one step; times in s from the step, None if a level is never reached."""

    rise_time: float | None
    """From the first crossing of 10 % to that of 90 % of the change."""
    overshoot: float
    """Share of the change by which the largest value passes the target; 0 if none does."""
    settling_time: float | None
    """Time from which on the response stays in the band around the target."""
    steady_error: float
    """Target less the mean over the last tenth, in the signal's unit."""
    ripple: float
    """Standard deviation over the last tenth, in the signal's unit."""


def step_figures(
        t: np.ndarray, y: np.ndarray, start: float, target: float,
        band: float = 0.05) -> StepFigures:
    """
    Return the figures of a response ``y`` to a step from ``start`` to ``target`` at t = 0.

    ``t`` (s) is ascending from the step on, ``band`` the settling band as a share of the
    change. Crossings are interpolated between samples.

    Raises
    ------
    AnalysisError
        No step, too few samples to average an end, or an empty band.

    """
    change = target - start
    if change == 0.0:
        raise AnalysisError(f'step from {start:g} to {target:g}: start and target must differ')
    if not 0.0 < band < 1.0:
        raise AnalysisError(f'settling band = {band:g}, must be > 0 and < 1 of the step')
    if len(t) * TAIL < 1.0 or len(t) != len(y):
        raise AnalysisError(
            f'{len(t)} times and {len(y)} values of a step, must be equally many, and at least '
            f'{1.0 / TAIL:g}')
    share = (np.asarray(y, dtype=float) - start) / change
    low, high = (_first_crossing(t, share, level) for level in RISE)
    tail = np.asarray(y)[-int(len(t) * TAIL):]
    return StepFigures(
        rise_time=None if low is None or high is None else high - low,
        overshoot=max(0.0, float(share.max()) - 1.0),
        settling_time=_settled(t, share, band),
        steady_error=target - float(tail.mean()), ripple=float(tail.std()))


def _first_crossing(t: np.ndarray, share: np.ndarray, level: float) -> float | None:
    above = np.flatnonzero(share >= level)
    if not len(above):
        return None
    k = int(above[0])
    return float(t[0]) if k == 0 else _interpolated(t, share, level, k)


def _settled(t: np.ndarray, share: np.ndarray, band: float) -> float | None:
    outside = np.flatnonzero(np.abs(share - 1.0) > band)
    if not len(outside):
        return float(t[0])
    k = int(outside[-1]) + 1
    if k == len(t):
        return None
    return _interpolated(t, share, 1.0 + band if share[k - 1] > 1.0 else 1.0 - band, k)


def _interpolated(t: np.ndarray, share: np.ndarray, level: float, k: int) -> float:
    part = (level - share[k - 1]) / (share[k] - share[k - 1])
    return float(t[k - 1] + part * (t[k] - t[k - 1]))
