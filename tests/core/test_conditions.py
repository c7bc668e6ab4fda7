"""The conditions as data: bits, names, words."""

from hypothesis import given, strategies as st
import isa_ros
from isa_ros.core.conditions import BITS, CONDITIONS, conditions, shown, words
from isa_ros.reu.reports import reports
import pytest
from tests.reu.watched import only, Watched

ALL = (1 << len(CONDITIONS)) - 1


def test_a_bit_is_the_place_of_its_condition() -> None:
    """Bits are written to bags: a condition keeps its bit, a new one is appended."""
    assert list(BITS.items()) == [
        ('setpoint_timeout', 0), ('end_of_stroke', 1), ('overspeed', 2), ('overload', 3),
        ('overpressure', 4), ('overcurrent', 5), ('overtemperature', 6), ('supply_low', 7),
        ('relief_open', 8), ('load_cell_implausible', 9), ('encoder_jump', 10),
        ('link_lost', 11), ('spool_deviation', 12)]


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


@pytest.mark.parametrize(('given', 'is_trip', 'is_rotary', 'text'), [
    (('overpressure', 23.81e6, 23.75e6, 0.05), False, False,
     'higher chamber pressure 23.81 MPa, above its warning level 23.75 MPa for 50 ms'),
    (('end_of_stroke', 0.0004, 0.001), True, False,
     'distance to the nearer end of the stroke 0.4 mm, below its trip level 1 mm'),
    (('end_of_stroke', 0.0004, 0.001), True, True,
     'distance to the nearer end of the stroke 0.0004 rad, below its trip level 0.001 rad'),
    (('overload', 196.5, 190.0), False, True,
     'measured force 196.5 Nm, above its warning level 190 Nm'),
    (('overtemperature', 81.0, 80.0, 0.1), True, False,
     'temperature 81 celsius, above its trip level 80 celsius for 100 ms'),
    (('setpoint_timeout', None, 0.1), True, False,
     'time since the last setpoint above its trip level 100 ms'),
])
def test_words_name_quantity_value_level_and_unit(
        given: tuple[str, float, float], is_trip: bool, is_rotary: bool, text: str) -> None:
    assert words(*given, is_trip=is_trip, is_rotary=is_rotary) == text


@pytest.mark.parametrize('condition', CONDITIONS, ids=lambda condition: condition.name)
def test_every_condition_has_words_for_both_kinds_of_actuators(condition: object) -> None:
    for is_rotary in (False, True):
        text = words(condition.name, 1.0, 2.0, is_rotary=is_rotary)  # type: ignore[attr-defined]
        assert '|' not in text and '\n' not in text


def test_small_and_large_values_have_readable_units() -> None:
    assert [shown(12.5e-3, 'A'), shown(2.1e7, 'Pa'), shown(1.5, 'm/s'), shown(0.02, 's')] == [
        '12.5 mA', '21 MPa', '1.5 m/s', '20 ms']


def test_reports_begin_with_the_cause() -> None:
    """A trip has the value that caused it, also when the quantity is back."""
    watched = Watched(only(
        'overload', warning=0.4, trip=0.5, delay_ms=0.1, reaction='disable'))
    watched.convert(3)
    watched.show('overload', 6e3)
    watched.convert(2)
    watched.show('overload', 4500.0)
    watched.convert(2)
    [report] = reports(watched.constants, watched.own)
    assert report == (
        'overload', True, True, 20, 'disable',
        'measured force 6000 N, above its trip level 5000 N for 0.1 ms')
    watched.own.trips = watched.own.first = 0
    [warning] = reports(watched.constants, watched.own)
    assert (warning.is_trip, warning.since_step, warning.reaction) == (False, 20, '')
    assert warning.text == 'measured force 4500 N, above its warning level 4000 N for 0.1 ms'
