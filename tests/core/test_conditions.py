"""The conditions as data: bits and names."""

from hypothesis import given, strategies as st
import isa_ros
from isa_ros.core.conditions import BITS, CONDITIONS, conditions
import pytest

ALL = (1 << len(CONDITIONS)) - 1


def test_a_bit_is_the_place_of_its_condition() -> None:
    """Bits are written to bags: a condition keeps its bit, a new one is appended."""
    assert list(BITS.items()) == [
        ('setpoint_timeout', 0), ('end_of_stroke', 1), ('overspeed', 2), ('overload', 3),
        ('overpressure', 4), ('overcurrent', 5), ('overtemperature', 6), ('supply_low', 7),
        ('relief_open', 8), ('load_cell_implausible', 9), ('encoder_jump', 10),
        ('link_lost', 11), ('spool_deviation', 12), ('watchdog', 13), ('sensor_range', 14),
        ('position_error', 15), ('force_error', 16), ('oscillation', 17), ('runaway', 18)]


@given(st.integers(0, ALL))
def test_a_bit_set_has_the_names_of_its_bits(value: int) -> None:
    """As a float, which a `SAMPLE` has, too."""
    names = conditions(float(value))
    assert sum(1 << BITS[name] for name in names) == value
    assert isa_ros.conditions(value) == names


@pytest.mark.parametrize('value', [-1.0, 0.5, ALL + 1.0, float('inf'), float('nan')])
def test_what_is_no_bit_set_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match='is not a set of conditions'):
        conditions(value)
