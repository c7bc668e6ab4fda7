"""
`pytest.approx` without its trap for small SI numbers.

A capacitance is 1e-11 m3/Pa and a leakage 1e-6 m3/s, but the absolute tolerance that
`pytest.approx` adds unasked is 1e-12 of whatever unit: 0.0 == approx(2.9e-13) holds.
"""

from typing import Any

import numpy as np
import pytest

DEFAULT_ABS = 1e-12
DEFAULT_REL = 1e-6

_approx = pytest.approx


def refusing_approx(expected: Any, rel: float | None = None, **options: Any) -> Any:
    """
    Return `pytest.approx`, unless its default absolute tolerance is the wider one.

    Raises
    ------
    ValueError
        Of a number the default ``abs`` allows more than ``rel`` does.

    """
    if options.get('abs') is None:
        allowed = DEFAULT_REL if rel is None else rel
        for size in _sizes(expected):
            if allowed * size < DEFAULT_ABS:
                raise ValueError(
                    f'approx({size:g}) allows the default abs = {DEFAULT_ABS:g}, more than '
                    f'rel = {allowed:g} of it; give abs=0.0 with a derived rel, or a derived abs')
    return _approx(expected, rel=rel, **options)


def _sizes(expected: Any) -> list[float]:
    """Return the magnitudes of the finite numbers in what `pytest.approx` accepts."""
    values = list(expected.values()) if isinstance(expected, dict) else expected
    sizes = np.abs(np.ravel(np.asarray(values, dtype=complex)))
    found: list[float] = sizes[np.isfinite(sizes)].tolist()
    return found
