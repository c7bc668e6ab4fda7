"""Protection alone: levels, delays, hysteresis, latching, reactions."""

from dataclasses import replace

from hypothesis import given, settings, strategies as st
from isa_ros.core.conditions import BITS, CONDITIONS, conditions, REACTIONS
from isa_ros.core.parameter import defaults
from isa_ros.core.record import rows_of
from isa_ros.core.signals import SAMPLE
from isa_ros.reu import protection
from isa_ros.reu.protection import GONE, request_clear, TAKEN, write_trips
from isa_ros.reu.protection_sheet import levels_of, Protection
from isa_ros.reu.reactions import protect
import numpy as np
import pytest
from tests.reu.watched import NAMES, only, PERIOD, RATINGS, STROKE, Watched

EPSILON = 1e-6  # of a level: the readings are sums, exact to 1e-12 of their terms


def beyond(name: str, level: float, by: float) -> float:
    """Return the quantity that is beyond a level by a part of it."""
    return level * (1.0 + by if CONDITIONS[BITS[name]].is_above else 1.0 - by)


def rated(name: str, level: float) -> float:
    return level * RATINGS.of(name)


@pytest.mark.parametrize('name', NAMES)
def test_a_condition_begins_right_beyond_its_levels(name: str) -> None:
    """The warning beyond its level, the trip beyond its own, neither of them at the level."""
    first, second = (0.2, 0.4) if CONDITIONS[BITS[name]].is_above else (0.4, 0.2)
    if name == 'overtemperature':
        first, second = 70.0, 80.0
    found = []
    for level, by in ((first, -EPSILON), (first, EPSILON), (second, -EPSILON), (second, EPSILON)):
        watched = Watched(only(name, warning=first, trip=second, delay_ms=0.0))
        watched.show(name, beyond(name, rated(name, level), by))
        watched.convert()
        found.append(watched.has(name))
        assert watched.own.warnings | watched.own.trips in (0, 1 << BITS[name])
    assert found == [(False, False), (True, False), (True, False), (True, True)]


@pytest.mark.parametrize('name', NAMES)
def test_a_level_of_zero_or_no_reaction_is_off(name: str) -> None:
    level = 60.0 if name == 'overtemperature' else 0.1
    for sheet in (only(name), only(name, warning=level, trip=level, reaction='none')):
        assert np.isinf(Watched(sheet).constants.quiet).all()


def test_the_switch_turns_all_off() -> None:
    assert Watched(defaults(Protection)).constants.is_on == 1
    assert Watched(replace(defaults(Protection), switch='off')).constants.is_on == 0


@pytest.mark.parametrize(('delay_ms', 'conversions'), [
    (0.0, 0), (0.1, 1), (0.11, 2), (1.3, 13), (10.0, 100), (50.0, 500)])
def test_the_delay_is_counted_in_conversions(delay_ms: float, conversions: int) -> None:
    """A trip is set as many conversions after the first one beyond the level, and not before."""
    watched = Watched(only('overload', trip=0.5, delay_ms=delay_ms))
    watched.show('overload', 5001.0)
    watched.convert(conversions)
    assert watched.own.trips == 0
    watched.convert()
    assert watched.has('overload') == (False, True)
    assert watched.own.trip_since[BITS['overload']] == conversions * 5
    assert watched.own.trip_values[BITS['overload']] == 5001.0


def test_one_conversion_inside_begins_the_delay_anew() -> None:
    watched = Watched(only('overload', trip=0.5, delay_ms=1.0))
    for force in (5001.0, 4999.0, 5001.0):
        watched.show('overload', force)
        watched.convert(10 if force > 5e3 else 1)
    assert watched.own.trips == 0
    watched.convert()
    assert watched.has('overload')[1]


@given(
    name=st.sampled_from(('overload', 'supply_low', 'relief_open', 'end_of_stroke')),
    level=st.floats(0.1, 0.5), hysteresis=st.just(0.0) | st.floats(1e-9, 0.5),
    delay=st.integers(0, 4),
    factors=st.lists(st.floats(0.0, 2.0), min_size=1, max_size=40))
@settings(max_examples=60, deadline=None)
def test_a_warning_is_that_of_its_definition(
        name: str, level: float, hysteresis: float, delay: int, factors: list[float]) -> None:
    """Beyond the level for the delay it begins; it ends when back by the hysteresis."""
    watched = Watched(only(name, hysteresis, warning=level, delay_ms=delay * PERIOD * 1e3))
    sign = 1.0 if CONDITIONS[BITS[name]].is_above else -1.0
    bound = rated(name, level)
    end, warns, run = bound * (1.0 - sign * hysteresis), False, 0
    for factor in factors:
        quantity = factor * bound
        watched.show(name, quantity)
        watched.convert()
        if name == 'end_of_stroke':
            quantity = min(quantity, STROKE - quantity)
        run = run + 1 if sign * quantity > sign * bound else 0
        warns = sign * quantity > sign * end if warns else run > delay
        assert watched.has(name) == (warns, False)


@pytest.mark.parametrize('reaction', REACTIONS[1:])
def test_only_a_reaction_that_stops_is_kept_until_it_is_cleared(reaction: str) -> None:
    watched = Watched(only('overload', trip=0.5, delay_ms=0.2, reaction=reaction))
    for force in (6e3, 0.0):
        watched.show('overload', force)
        watched.convert(3)
    stops = reaction in ('quick_stop', 'disable', 'block')
    assert watched.has('overload') == (False, stops)
    assert watched.own.reaction == (REACTIONS.index(reaction) if stops else 0)
    request_clear(watched.own)
    watched.convert()
    assert (watched.own.trips, watched.own.first, watched.own.reaction) == (0, 0, 0)


def test_a_trip_is_not_cleared_before_its_condition_has_ended() -> None:
    """And a clear that came too early does not act later."""
    watched = Watched(only('overload', 0.1, trip=0.5, delay_ms=0.2, reaction='disable'))
    for force in (6e3, 4600.0, 4400.0):
        watched.show('overload', force)
        watched.convert(3)
        assert watched.has('overload')[1]
        if force > 5e3:
            request_clear(watched.own)
    watched.convert()
    assert watched.has('overload')[1] and not watched.own.present
    request_clear(watched.own)
    watched.convert()
    assert watched.own.trips == 0


def test_a_cause_that_is_cleared_gives_way_to_a_trip_that_persists() -> None:
    levels = defaults(Protection).supply_low
    watched = Watched(replace(
        only('overload', trip=0.5, delay_ms=0.0, reaction='disable'),
        supply_low=replace(levels, warning=0.5, trip=0.5, delay_ms=0.0)))
    watched.show('overload', 6e3)
    watched.convert()
    watched.show('supply_low', 1e6)
    watched.show('overload', 0.0)
    watched.convert()
    assert watched.own.first == 1 << BITS['overload']
    request_clear(watched.own)
    watched.convert()
    assert watched.own.trips == watched.own.first == 1 << BITS['supply_low']


def test_of_two_trips_of_one_conversion_one_is_the_first() -> None:
    levels = defaults(Protection).supply_low
    watched = Watched(replace(
        only('overload', trip=0.5, delay_ms=0.0, reaction='disable'),
        supply_low=replace(levels, trip=0.5, delay_ms=0.0)))
    watched.show('overload', 6e3)
    watched.show('supply_low', 1e6)
    watched.convert()
    both = [1 << BITS[name] for name in ('overload', 'supply_low')]
    assert watched.own.trips == sum(both)
    assert watched.own.first == min(both)


def test_the_first_cause_is_kept_and_the_strongest_reaction_acts() -> None:
    sheet = replace(
        only('overload', trip=0.5, delay_ms=0.0, reaction='hold'),
        supply_low=replace(
            defaults(Protection).supply_low, trip=0.5, delay_ms=0.0, reaction='disable'))
    watched = Watched(sheet)
    watched.show('overload', 6e3)
    watched.convert()
    assert watched.own.reaction == protection.HOLD
    watched.show('supply_low', 1e6)
    watched.convert()
    assert watched.own.first == 1 << BITS['overload']
    assert watched.own.trips == 1 << BITS['overload'] | 1 << BITS['supply_low']
    assert watched.own.reaction == protection.DISABLE


def test_a_trip_is_the_same_in_plain_python() -> None:
    """Compiled and interpreted, bit by bit, through warning, trip, reaction and end."""
    def states(convert: object) -> list[bytes]:
        watched = Watched(replace(defaults(Protection), hysteresis=0.1))
        found = []
        for name, quantity in (('overcurrent', 12.45e-3), ('supply_low', 9e6),
                               ('load_cell_implausible', 3e3), ('supply_low', 1e6)):
            watched.show(name, quantity)
            for _ in range(120):
                convert(watched.step, watched.supply, watched.temperature,  # type: ignore
                        watched.constants, watched.state)
                watched.step += 5
                found.append(watched.state.tobytes())
        assert watched.own.trips and watched.own.warnings
        return found
    assert states(protect) == states(protect.py_func)


def test_a_supply_that_an_emergency_stop_took_is_not_low_until_it_is_back() -> None:
    """It has fallen below the trip at 4.4 MPa and is back beyond the hysteresis, 4.84 MPa."""
    watched = Watched(only('supply_low', 0.1, trip=0.2, delay_ms=0.0, reaction='disable'))
    watched.state.status.is_on, watched.own.supply_taken = 0, TAKEN
    for pressure, taken in ((20e6, TAKEN), (5e6, TAKEN), (4e6, GONE), (0.0, GONE), (4.6e6, GONE),
                            (5e6, 0)):
        watched.show('supply_low', pressure)
        watched.convert()
        assert (watched.own.supply_taken, watched.own.trips) == (taken, 0), pressure
    watched.show('supply_low', 4e6)
    watched.convert()
    assert watched.has('supply_low')[1]


def test_outputs_that_are_on_need_the_supply_whatever_took_it() -> None:
    watched = Watched(only('supply_low', 0.1, trip=0.2, delay_ms=0.0, reaction='disable'))
    watched.own.supply_taken = TAKEN
    watched.show('supply_low', 1e6)
    watched.convert()
    assert watched.own.supply_taken == 0 and watched.has('supply_low')[1]


def test_while_the_supply_is_taken_only_its_own_condition_rests() -> None:
    levels = defaults(Protection).supply_low
    watched = Watched(replace(
        only('overload', trip=0.5, delay_ms=0.0, reaction='disable'),
        supply_low=replace(levels, trip=0.2, delay_ms=0.0)))
    watched.state.status.is_on, watched.own.supply_taken = 0, TAKEN
    watched.show('supply_low', 1e6)
    watched.show('overload', 6e3)
    watched.convert()
    assert conditions(float(watched.own.trips)) == ['overload']


def test_what_moved_while_a_program_stood_still_is_no_jump() -> None:
    """The time is judged once, by the first conversion after it."""
    watched = Watched(defaults(Protection), watchdog=5e-3)
    watched.convert(2)
    watched.state.frozen_for, watched.state.measured.position = 4e-3, 0.08
    watched.convert()
    assert watched.own.values[BITS['encoder_jump']] == 0.0
    assert watched.own.values[BITS['watchdog']] == 4e-3 and watched.state.frozen_for == 0.0
    watched.state.link_silence = 2e-3
    watched.convert()
    assert watched.own.values[BITS['watchdog']] == 0.0
    assert watched.own.values[BITS['link_lost']] == 2e-3


def test_a_trip_keeps_its_cause() -> None:
    """A trip has the value that caused it, also when the quantity is back."""
    watched = Watched(only(
        'overload', warning=0.4, trip=0.5, delay_ms=0.1, reaction='disable'))
    watched.convert(3)
    watched.show('overload', 6e3)
    watched.convert(2)
    watched.show('overload', 4500.0)
    watched.convert(2)
    bit = BITS['overload']
    assert watched.own.first == watched.own.trips == watched.own.warnings == 1 << bit
    assert (watched.own.trip_since[bit], watched.own.warning_since[bit]) == (20, 20)
    assert (watched.own.trip_values[bit], watched.own.values[bit]) == (6000.0, 4500.0)


def test_the_sample_names_the_last_trip_its_time_and_its_quantity() -> None:
    """And the first one; overload is bit 3 and supply_low bit 7, both in this REU."""
    levels = levels_of(defaults(Protection))
    watched = Watched(replace(
        only('overload', trip=0.5, delay_ms=0.0, reaction='disable'),
        supply_low=replace(levels['supply_low'], trip=0.2, delay_ms=0.0)))
    watched.show('overload', 6e3)
    watched.convert(2)
    watched.show('supply_low', 3e6)
    watched.convert(2)
    sample = rows_of(1, SAMPLE)[0]
    write_trips(watched.own, sample)
    assert conditions(sample.last_trip) == ['supply_low']
    assert conditions(sample.first_trip) == ['overload']
    assert (sample.trip_time, sample.trip_value) == (pytest.approx(2 * PERIOD), 3e6)
    assert sample.trip_level == pytest.approx(0.2 * RATINGS.opening_pressure)
