"""Energies as integrals over the plant steps."""

from isa_ros.actuator.integration import simpson
import numpy as np
import pytest


@pytest.mark.parametrize('n', [2, 3, 4, 5, 7, 10, 25, 50])
def test_simpson_is_exact_for_cubic_polynomials(n):
    x = np.arange(n + 1)
    weights = [simpson(k, n) for k in range(n + 1)]
    for power in range(4):
        assert np.dot(weights, x ** power) == pytest.approx(n ** (power + 1) / (power + 1))
    assert np.dot(weights, x ** 4) != pytest.approx(n ** 5 / 5, rel=1e-9)


def test_one_interval_is_a_trapezium():
    assert [simpson(0, 1), simpson(1, 1)] == [0.5, 0.5]
