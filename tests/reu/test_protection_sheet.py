"""The sheet of a protection: its defaults, and levels and reactions that are refused."""

import math

from hypothesis import given, settings, strategies as st
from isa_ros.core.conditions import BITS, CONDITIONS, REACTIONS
from isa_ros.core.parameter import defaults
from isa_ros.errors import ParameterError
from isa_ros.reu.protection_sheet import levels_of, Protection
import numpy as np
import pytest
from tests.reu.watched import NAMES, only, Watched


def test_every_condition_has_levels_or_a_timeout() -> None:
    """Keys, bits and readings of this test name the same conditions."""
    timeouts = {'setpoint_timeout', 'link_lost', 'watchdog'}
    assert set(levels_of(defaults(Protection))) == set(BITS) - timeouts == set(NAMES)


@given(
    name=st.sampled_from(NAMES), warning=st.floats(0.01, 0.4), trip=st.floats(0.01, 0.4))
@settings(max_examples=60)
def test_a_warning_beyond_its_trip_is_refused(name: str, warning: float, trip: float) -> None:
    """With one line that names both, their values and their unit."""
    is_above = CONDITIONS[BITS[name]].is_above
    unit = ' celsius' if name == 'overtemperature' else ''
    if warning <= trip if is_above else warning >= trip:
        only(name, warning=warning, trip=trip)
        return
    with pytest.raises(ParameterError) as refused:
        only(name, warning=warning, trip=trip)
    assert str(refused.value) == (
        f'{name}.warning = {warning:g}{unit}, must be {"<=" if is_above else ">="} '
        f'{name}.trip = {trip:g}{unit}')


@pytest.mark.parametrize(('levels', 'message'), [
    ({'delay_ms': -1.0}, 'Overload.delay_ms = -1 ms, must be >= 0 ms'),
    ({'trip': -0.1}, 'Overload.trip = -0.1, must be >= 0 '),
    ({'trip': 1.1}, 'Overload.trip = 1.1, must be <= 1 '),
    ({'trip': math.nan}, 'Overload.trip = nan, must be finite'),
    ({'reaction': 'explode'}, "Overload.reaction = 'explode', must be one of none, warn, limit"),
])
def test_bad_levels_are_refused(levels: dict[str, float], message: str) -> None:
    with pytest.raises(ParameterError) as refused:
        only('overload', **levels)
    assert str(refused.value).startswith(message)


def test_the_default_watches_all_but_the_ends_and_the_setpoints() -> None:
    constants = Watched(defaults(Protection)).constants
    is_watched = np.isfinite(constants.quiet)
    assert [name for name, k in BITS.items() if not is_watched[k]] == [
        'setpoint_timeout', 'end_of_stroke', 'link_lost', 'watchdog']
    assert np.isfinite(Watched(defaults(Protection), 5e-3).constants.trip[BITS['watchdog']])


@pytest.mark.parametrize(('name', 'refused', 'left'), [
    ('end_of_stroke', ('hold', 'damp', 'quick_stop', 'disable', 'block'),
     'none or warn or limit'),
    ('load_cell_implausible', ('hold', 'damp', 'quick_stop'), 'none or warn or disable or block'),
    ('encoder_jump', ('hold', 'damp', 'quick_stop'), 'none or warn or disable or block')])
def test_a_reaction_that_could_not_end_or_uses_what_is_wrong_is_refused(
        name: str, refused: tuple[str, ...], left: str) -> None:
    """At the end of the stroke nothing else could be left; a stop needs encoder and load cell."""
    for reaction in REACTIONS:
        if reaction in refused:
            with pytest.raises(ParameterError, match=f'{name}.reaction = {reaction}, must be '
                                                     f'{left}: '):
                only(name, reaction=reaction)
        elif reaction in left:
            only(name, reaction=reaction)
