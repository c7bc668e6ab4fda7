"""Conditions whose levels, reaction or mask change: how those in force end, and begin again."""

from dataclasses import replace

from isa_ros.core.conditions import BITS
from isa_ros.core.parameter import defaults
from isa_ros.reu import protection
from isa_ros.reu.protection import EXTENDING, request_clear
from isa_ros.reu.protection_sheet import Protection
from isa_ros.reu.reactions import is_cause_gone
import pytest
from tests.reu.watched import only, Watched

OVERLOAD = 1 << BITS['overload']
SHEET = only('overload', 0.1, warning=0.2, trip=0.5, delay_ms=0.2, reaction='limit')


def _with(**levels: object) -> Protection:
    return replace(SHEET, overload=replace(SHEET.overload, **levels))


@pytest.mark.parametrize('loosened', [
    replace(SHEET, mask=float(OVERLOAD)), _with(reaction='none'), _with(warning=0.7, trip=0.8),
    _with(warning=0.0, trip=0.0)], ids=['masked', 'none', 'loosened', 'off'])
def test_a_condition_in_force_ends_when_it_is_masked_or_loosened(loosened: Protection) -> None:
    """Warning, trip and inhibited direction, while the quantity stays; armed again, it delays."""
    watched = Watched(SHEET)
    watched.show('overload', 6e3)
    watched.convert(3)
    assert watched.has('overload') == (True, True) and watched.own.inhibited == EXTENDING
    watched.become(loosened)
    watched.convert()
    own = watched.own
    assert (own.warnings, own.trips, own.present, own.busy, own.first) == (0, 0, 0, 0, 0)
    assert (own.reaction, own.inhibited) == (0, 0)
    watched.convert(5)
    watched.become(SHEET)
    watched.convert(2)
    assert watched.has('overload') == (False, False)
    watched.convert()
    assert watched.has('overload') == (True, True) and watched.own.inhibited == EXTENDING


@pytest.mark.parametrize('loosened', [
    replace(SHEET, mask=float(OVERLOAD)), _with(reaction='none'), _with(reaction='warn'),
    _with(warning=0.7, trip=0.8)], ids=['masked', 'none', 'warn', 'loosened'])
def test_what_has_stopped_the_actuator_is_cleared_by_its_user_alone(loosened: Protection) -> None:
    watched = Watched(_with(reaction='disable'))
    watched.show('overload', 6e3)
    watched.convert(3)
    assert not is_cause_gone(watched.constants, watched.state)
    watched.become(loosened)
    watched.convert(3)
    assert watched.own.trips == watched.own.first == OVERLOAD
    assert is_cause_gone(watched.constants, watched.state)
    request_clear(watched.own)
    watched.convert()
    still_met = OVERLOAD if loosened.overload.reaction == 'warn' else 0
    assert watched.own.trips == still_met


def test_a_stronger_reaction_acts_on_a_trip_that_is_there() -> None:
    watched = Watched(_with(reaction='warn'))
    watched.show('overload', 6e3)
    watched.convert(3)
    assert watched.own.reaction == protection.WARN
    watched.become(_with(reaction='disable'))
    watched.convert()
    assert watched.own.reaction == protection.DISABLE
    watched.show('overload', 0.0)
    watched.convert()
    assert watched.own.trips == OVERLOAD    # it has stopped the actuator


def test_a_tighter_level_and_a_shorter_delay_count_what_has_been_beyond_them() -> None:
    watched = Watched(_with(delay_ms=1.0))
    watched.show('overload', 6e3)
    watched.convert(5)
    assert watched.has('overload') == (False, False)
    watched.become(_with(delay_ms=0.5))     # more than 5 conversions: this is the sixth
    watched.convert()
    assert watched.has('overload') == (True, True)


def test_a_mask_hides_its_conditions_alone() -> None:
    sheet = replace(SHEET, supply_low=replace(
        defaults(Protection).supply_low, trip=0.5, delay_ms=0.0), mask=float(OVERLOAD))
    watched = Watched(sheet)
    watched.show('overload', 6e3)
    watched.show('supply_low', 1e6)
    watched.convert(5)
    assert watched.own.trips == 1 << BITS['supply_low']
    assert not watched.has('overload')[0]
