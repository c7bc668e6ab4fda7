"""Rows of numbers that a saved state has."""

from isa_ros.core.changing_values import ChangingValues


def test_what_was_accepted_before_the_save_is_put_in_force_after_it():
    """Also by values that had settled."""
    own, other = (ChangingValues('own', ['a', 'b'], [1.0, 2.0]) for _ in range(2))
    assert not own.latch() and not other.latch() and other.is_settled
    own.accept({'b': 3.0})
    other.restore(own.snapshot())
    assert other.latch() and other.in_force == {'b': 3.0}
