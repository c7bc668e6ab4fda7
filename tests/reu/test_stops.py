"""Movements that the device commands itself, piece by piece: what a stop bears, the way back."""

import math

from isa_ros.core.device import CURRENT, FORCE, IMPEDANCE, PRESSURE, SPOOL
from isa_ros.reu import stops
import pytest
from tests.reu.devices import constants
from tests.reu.states import enabled_state

REU = constants()
RULES = REU.rules
STIFFNESS = 1e5


@pytest.mark.parametrize(('mode', 'reference'), [
    (IMPEDANCE, 300.0), (FORCE, 300.0), (PRESSURE, 4e6), (SPOOL, 0.0), (CURRENT, 0.0)])
def test_a_mode_that_begins_at_rest_bears_the_load(mode, reference):
    """The force without its swinging, or the load pressure; further in the valve is at null."""
    state = enabled_state(REU)
    state.measured.force, state.status.flow.slow_force = 900.0, 300.0
    state.measured.pressure_a, state.measured.pressure_b = 9e6, 5e6
    assert stops.bearing_reference(mode, state) == reference


def test_the_place_of_a_stop_is_the_one_that_its_law_holds():
    state = enabled_state(REU)
    stop, flow = state.status.stop, state.status.flow
    state.supply_pressure = 20e6
    stop.position, stop.velocity = 0.05, 0.3
    stops.command_stop(RULES, state)
    assert stop.position == 0.05
    flow.is_held, flow.place = 1, 0.07
    stops.command_stop(RULES, state)
    assert stop.position == 0.07


def returning(position=0.05, effort=0.0, target=0.06, aim=0.0):
    """Return a state on its way from a place and an effort to those of its setpoint."""
    state = enabled_state(REU)
    state.measured.position = position
    state.status.return_speed = 9.0     # of a way back before
    stops.begin_return(effort, state)
    setpoint = state.setpoint
    setpoint.position, setpoint.effort, setpoint.stiffness = target, aim, STIFFNESS
    return state


def way(state, conversions):
    """Return places and efforts of a way back."""
    found = []
    for _ in range(conversions):
        stops.advance_return(RULES, state)
        if not state.status.is_returning:
            break
        found.append((float(state.status.back.position), float(state.status.back.effort)))
    return found


def test_a_way_back_begins_at_rest_and_keeps_the_declared_speed():
    """Every one of them, also the second: v = a t at first, at most the return speed."""
    state = returning(target=0.09)
    a, period = RULES.flow.deceleration, RULES.period
    stops.advance_return(RULES, state)
    assert state.status.return_speed == pytest.approx(a * period)
    assert state.status.back.position - 0.05 == pytest.approx(a * period * period, abs=1e-15)
    places = [place for place, _ in way(state, 100_000)]
    fastest = max(after - before for before, after in zip(places, places[1:])) / period
    assert fastest == pytest.approx(RULES.return_speed, rel=1e-6)
    # it brakes: v^2 = 2 a (way left), to a step of the slowest speed
    left = 0.09 - places[-1]
    assert left <= 2.0 * math.sqrt(2.0 * a * left) * period


def test_an_effort_that_is_lacking_is_a_way_of_the_rest_and_goes_with_the_place():
    """1000 N over 1e5 N/m are 10 mm, which the rest does not jump."""
    state = returning(effort=-200.0, target=0.05, aim=800.0)
    found = way(state, 100_000)
    assert len(found) > 0.01 / (RULES.return_speed * RULES.period)
    efforts = [effort for _, effort in found]
    assert efforts == sorted(efforts) and -200.0 < efforts[0] < -199.0
    assert {place for place, _ in found} == {0.05}
    both = way(returning(effort=0.0, target=0.06, aim=500.0), 100_000)
    for place, effort in both:      # the same share of both
        assert (place - 0.05) / 0.01 == pytest.approx(effort / 500.0, abs=1e-12)


def test_a_setpoint_that_comes_by_ends_the_way_back():
    state = returning(target=0.06)
    way(state, 50)
    assert state.status.is_returning == 1
    state.setpoint.position = float(state.status.back.position) - 0.01    # faster than the way
    stops.advance_return(RULES, state)
    assert state.status.is_returning == 0
