"""The functions of exact steps: values, limits, and compiled as their source."""

import math

from isa_ros.core.phi import phi_1, phi_2
import pytest


@pytest.mark.parametrize('x', [-30.0, -1.0, -0.1, 0.4])
def test_they_are_integrals_of_the_exponential(x: float) -> None:
    """(e^x - 1)/x and (e^x - 1 - x)/x^2; in the test they cancel 1 and 3 digits at 0.1."""
    assert phi_1(x) == pytest.approx((math.exp(x) - 1.0) / x, rel=1e-14, abs=0.0)
    assert phi_2(x) == pytest.approx((math.exp(x) - 1.0 - x) / (x * x), rel=1e-12, abs=0.0)


def test_at_nothing_they_have_their_limits() -> None:
    assert (phi_1(0.0), phi_2(0.0)) == (1.0, 0.5)
    # 1 + x/2 and, but for the rounding of phi_1 over x, 1/2 + x/6
    assert phi_1(-1e-6) == pytest.approx(1.0 - 5e-7, rel=1e-12, abs=0.0)
    assert phi_2(-1e-6) == pytest.approx(0.5 - 1e-6 / 6.0, abs=1e-9)


@pytest.mark.parametrize('x', [-800.0, -1.0, -1e-9, -1e-300, 0.0])
def test_compiled_equals_python(x: float) -> None:
    assert (phi_1(x), phi_2(x)) == (phi_1.py_func(x), phi_2.py_func(x))
