"""Curves of straight lines: their points, order, inverse, and compiled equal to Python."""

from hypothesis import given, strategies as st
from isa_ros.core.piecewise import lines_record, POINTS, x_on_lines, y_on_lines
import numpy as np
import pytest

STEPS = st.lists(st.tuples(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3)), min_size=1,
                 max_size=POINTS - 1)
"""Distances from each point of a rising curve to the next."""


def curve(steps: list[tuple[float, float]]) -> tuple[np.ndarray, np.ndarray, np.record]:
    """Return the points of a rising curve from the origin, and its `LINES`."""
    x, y = np.vstack([(0.0, 0.0), np.cumsum(np.array(steps), axis=0)]).T
    return x, y, lines_record(x, y)


@given(steps=STEPS)
def test_every_point_is_on_the_curve(steps):
    """V15: bit for bit; behind the last point the curve is constant."""
    x, y, lines = curve(steps)
    assert [y_on_lines(at, lines) for at in x] == list(y)
    assert y_on_lines(2.0 * x[-1], lines) == y[-1]


@given(steps=STEPS, share=st.floats(0.0, 1.0))
def test_between_points_the_curve_is_straight(steps, share):
    """V15: as numpy's interpolation, a few roundings of the largest value apart."""
    x, y, lines = curve(steps)
    at = share * x[-1]
    assert y_on_lines(at, lines) == pytest.approx(np.interp(at, x, y), rel=0.0, abs=1e-14 * y[-1])


@given(steps=STEPS, shares=st.tuples(st.floats(0.0, 1.2), st.floats(0.0, 1.2)))
def test_a_rising_curve_never_falls(steps, shares):
    """V15: monotone but for the rounding of one product and one sum."""
    x, y, lines = curve(steps)
    low, high = (y_on_lines(share * x[-1], lines) for share in sorted(shares))
    assert low <= high + 4e-16 * y[-1]


@given(steps=STEPS, k=st.integers(0, POINTS - 1))
def test_a_curve_is_continuous_at_its_points(steps, k):
    """V15: the neighbouring float below a point changes y by the slope only."""
    x, y, lines = curve(steps)
    at = x[min(k, len(steps) - 1) + 1]
    below = np.nextafter(at, 0.0)
    gap = lines.slope.max() * (at - below) + 4e-16 * y[-1]
    assert 0.0 <= y_on_lines(at, lines) - y_on_lines(below, lines) + 4e-16 * y[-1] <= 2.0 * gap


@given(steps=STEPS, share=st.floats(0.0, 1.0))
def test_the_inverse_leads_back(steps, share):
    """R11: y(x(y)) = y, and the last point for any y behind it."""
    x, y, lines = curve(steps)
    wanted = share * y[-1]
    # x is rounded once, and y(x) has the slope: a part of 1e-15 of the steepest line over all x
    allowed = 1e-15 * (y[-1] + lines.slope.max() * x[-1])
    assert y_on_lines(x_on_lines(wanted, lines), lines) == pytest.approx(
        wanted, rel=0.0, abs=allowed)
    assert x_on_lines(2.0 * y[-1], lines) == x[-1]


@given(steps=STEPS, at=st.floats(0.0, 2e4))
def test_compiled_equals_python(steps, at):
    lines = curve(steps)[2]
    assert y_on_lines(at, lines) == y_on_lines.py_func(at, lines)
    assert x_on_lines(at, lines) == x_on_lines.py_func(at, lines)
