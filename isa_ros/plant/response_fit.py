"""
A spool that has the frequency response of a data sheet, at a small and at a large amplitude.

At the small one a second-order response has both stated points, -90 degrees and -3 dB. At the
large one the pilot stage's flow ends: the spool goes no faster than at a limited speed, found by
harmonic balance from the stated point. Both are those of the spool alone: hysteresis wears during
a run, and a spool does not become slower by it. What it adds to the lag is told by `sheet_fit`.
"""

import math
from typing import NamedTuple

from isa_ros.core.elementary import atan2
from isa_ros.errors import ParameterError

_MOST = math.sqrt(1.0 + math.sqrt(2.0))     # -3 dB over -90 degrees, without damping
_HALVINGS = 60
_TWO_PI = 2.0 * math.pi


class SecondOrder(NamedTuple):
    """w_n in rad/s, and zeta."""

    w_n: float
    zeta: float


def damping_of(at_90: float, at_3db: float) -> float:
    """
    Return zeta of a second-order response with -90 degrees and -3 dB at two frequencies  (V28).

    r^4 - 2 (1 - 2 zeta^2) r^2 = 1 with r their ratio.

    Raises
    ------
    ParameterError
        The -3 dB are too far beyond the -90 degrees.

    """
    r = at_3db / at_90
    if r >= _MOST:
        raise ParameterError(
            f'minus_3_db_hz = {at_3db:g} Hz, must be < {_MOST * at_90:.4g} Hz, {_MOST:.3f} times '
            f'minus_90_deg_hz = {at_90:g} Hz: a second-order response has no more')
    squared = r * r
    return math.sqrt(0.5 - 0.25 * (squared * squared - 1.0) / squared)


def leading(at_90: float, at_3db: float, t: float) -> float:
    """
    Return the frequency (Hz) of -90 degrees of a response behind something that lags  (V31).

    ``t`` is the tangent of that lag, below 1. At the frequency both together have -90 degrees at
    ``at_90`` Hz; the -3 dB stay. x = w_n^2 solves |H|^2 = 1/2 at the one and
    2 zeta w_n w t = w_n^2 - w^2 at the other.
    """
    stated, other = at_90 * at_90, at_3db * at_3db
    ratio = other / stated
    first, half = ratio - t * t, t * t * other + ratio * stated
    last = t * t * other * other + ratio * stated * stated
    return math.sqrt((half + math.sqrt(max(0.0, half * half - first * last))) / first)


def saturated(share: float) -> float:
    """Return the describing function of a saturation at ``share`` of its input's amplitude."""
    if share >= 1.0:
        return 1.0
    rest = math.sqrt(1.0 - share * share)
    return 2.0 / math.pi * (atan2(share, rest) + share * rest)


def magnitude(value: complex) -> float:
    """Return abs(value), rounded as sums, products and a root are."""
    return math.sqrt(value.real * value.real + value.imag * value.imag)


def gain_at(own: SecondOrder, frequency: float, n: float) -> complex:
    """Return the response of V29 at a frequency (Hz) whose saturation lets pass n of its input."""
    w, w_n = _TWO_PI * frequency, own.w_n
    return w_n * w_n * n / complex(w_n * w_n * n - w * w, 2.0 * own.zeta * w_n * w)


def passed_at_90(own: SecondOrder, frequency: float) -> float:
    """Return n with -90 degrees at a frequency: (w/w_n)^2."""
    ratio = _TWO_PI * frequency / own.w_n
    return ratio * ratio


def passed_at_3db(own: SecondOrder, frequency: float) -> float:
    """Return n with -3 dB at a frequency: n^2 + 2 n q = q^2 + 4 zeta^2 q, q = (w/w_n)^2."""
    ratio = _TWO_PI * frequency / own.w_n
    q = ratio * ratio
    return math.sqrt(2.0 * q * q + 4.0 * own.zeta * own.zeta * q) - q


def speed_limit(own: SecondOrder, frequency: float, n: float) -> float:
    """
    Return the largest speed per amplitude, 1/s, that lets pass n at a frequency  (V29).

    E = |1 - H| is the amplitude before the saturation at delta = 2 zeta v/w_n; N(delta/E) = n.
    """
    before = magnitude(1.0 - gain_at(own, frequency, n))
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if saturated(middle) < n:
            low = middle
        else:
            high = middle
    return high * before * own.w_n / (2.0 * own.zeta)


def response_at(own: SecondOrder, frequency: float, limit: float) -> complex:
    """Return the response at a frequency (Hz) under a speed limit per amplitude, 1/s; 0: none."""
    if limit == 0.0:
        return gain_at(own, frequency, 1.0)
    delta = 2.0 * own.zeta * limit / own.w_n
    low, high = 0.0, 1.0        # n: with more of it less is before the saturation
    for _ in range(_HALVINGS):
        n = 0.5 * (low + high)
        if saturated(delta / magnitude(1.0 - gain_at(own, frequency, n))) > n:
            low = n
        else:
            high = n
    return gain_at(own, frequency, high)
