"""The guard of `pytest.approx` that `tests/conftest.py` sets up for every test."""

import numpy as np
import pytest

LINE = 0.2e-3 / 7e8  # m3/Pa, capacitance of a line of oil


def test_the_default_tolerance_is_refused_where_it_is_wider_than_the_number() -> None:
    """Without the guard 0.0 == approx(2.9e-13): any capacitance of that size would pass."""
    with pytest.raises(ValueError, match='give abs=0.0 with a derived rel, or a derived abs'):
        pytest.approx(LINE)


@pytest.mark.parametrize('expected', [
    0.0, 1e-8, [1.0, 1e-8], {'a': 1.0, 'b': 1e-8}, np.array([[1.0], [1e-8]]), 1e-8j])
def test_each_number_of_a_collection_is_looked_at(expected: object) -> None:
    """The smallest decides, also of arrays, of dictionaries and of complex numbers."""
    with pytest.raises(ValueError, match='allows the default abs = 1e-12'):
        pytest.approx(expected)


def test_a_relative_tolerance_finer_than_the_default_is_refused() -> None:
    """1e-15 of 0.03 is below 1e-12: the test would not show what it claims."""
    with pytest.raises(ValueError, match='rel = 1e-15'):
        pytest.approx(0.03, rel=1e-15)


def test_what_says_its_tolerance_is_compared_as_before() -> None:
    """The guard only refuses; what it lets through is `pytest.approx`."""
    assert LINE * (1.0 + 1e-10) == pytest.approx(LINE, rel=1e-9, abs=0.0)
    assert LINE * (1.0 + 1e-8) != pytest.approx(LINE, rel=1e-9, abs=0.0)
    assert 1e-9 == pytest.approx(0.0, abs=1e-8)
    assert [1.0, float('nan')] == pytest.approx([1.0, float('nan')], nan_ok=True)
