"""What the trips of a protection cause: held, damped and inhibited commands; the watchdog."""

from dataclasses import replace

from hypothesis import given, settings, strategies as st
from isa_ros.core.conditions import BITS
from isa_ros.core.device import CURRENT, FORCE, IMPEDANCE, PRESSURE, SPOOL
from isa_ros.core.parameter import defaults
from isa_ros.reu.protection import feed, HOLD, NONE, QUICK_STOP, request_clear
from isa_ros.reu.protection_sheet import levels_of, Protection
from isa_ros.reu.reactions import is_cause_gone, is_inhibited, setpoint_in_force
import pytest
from tests.reu.watched import off, only, STROKE, Watched


def test_damp_is_damping_without_stiffness() -> None:
    """And the commanded gains are in force again afterwards."""
    watched = Watched(only('overload', trip=0.5, delay_ms=0.0, reaction='damp'))
    watched.show('overload', 6e3)
    watched.convert()
    damped = setpoint_in_force(watched.state)
    assert (damped.stiffness, damped.damping) == (0.0, 4e3)
    assert (damped.velocity, damped.effort) == (0.0, 0.0)
    watched.show('overload', 0.0)
    watched.convert()
    assert setpoint_in_force(watched.state).stiffness == 1e5


@pytest.mark.parametrize('mode', [CURRENT, SPOOL, PRESSURE, FORCE, IMPEDANCE])
def test_a_hold_is_a_hold_in_every_mode_and_ends_with_its_condition(mode: int) -> None:
    watched = Watched(only('overload', trip=0.5, delay_ms=0.0, reaction='hold'))
    watched.state.status.mode = mode
    watched.show('overload', 6e3)
    watched.convert()
    assert watched.own.reaction == HOLD
    watched.show('overload', 0.0)
    watched.convert()
    assert watched.has('overload') == (False, False) and watched.own.reaction == NONE


@pytest.mark.parametrize('mode', [CURRENT, SPOOL, PRESSURE, FORCE])
def test_without_a_position_block_in_the_mode_damp_is_a_quick_stop(mode: int) -> None:
    """Which stays until it is cleared, as any trip that stops the actuator."""
    watched = Watched(only('overload', trip=0.5, delay_ms=0.0, reaction='damp'))
    watched.state.status.mode = mode
    watched.show('overload', 6e3)
    watched.convert()
    assert watched.own.reaction == QUICK_STOP
    assert setpoint_in_force(watched.state).effort == 50.0  # until the device begins to stop
    assert not is_cause_gone(watched.constants, watched.state)
    watched.show('overload', 0.0)
    watched.convert(2)
    assert watched.has('overload') == (False, True)
    assert is_cause_gone(watched.constants, watched.state)
    request_clear(watched.own)
    watched.convert()
    assert watched.has('overload') == (False, False) and watched.own.reaction == NONE


@pytest.mark.parametrize(('name', 'quantity', 'extends'), [
    ('end_of_stroke', 0.099, True), ('end_of_stroke', 0.001, False),
    ('overspeed', -2.0, True), ('overspeed', 2.0, False), ('overload', 9e3, True),
    ('relief_open', 23e6, True), ('overpressure', 23e6, False)])
def test_limit_inhibits_the_direction_that_makes_it_worse(
        name: str, quantity: float, extends: bool) -> None:
    watched = Watched(only(name, trip=0.5, delay_ms=0.0, reaction='limit'))
    watched.show(name, quantity)
    if name == 'overspeed':
        watched.state.speed.velocity = -quantity
    watched.convert()
    assert watched.has(name)[1]
    assert is_inhibited(1e-4, watched.own) == extends
    assert is_inhibited(-1e-4, watched.own) == (not extends)
    assert not is_inhibited(0.0, watched.own)
    watched.show(name, 0.5 * STROKE if name == 'end_of_stroke' else 0.0)
    watched.convert()
    assert not is_inhibited(1e-4, watched.own) and not is_inhibited(-1e-4, watched.own)


@pytest.mark.parametrize('reaction', ['hold', 'damp', 'disable'])
def test_the_watchdog_trips_one_conversion_after_its_time(reaction: str) -> None:
    """And ends with the next setpoint, unless the actuator is disabled."""
    watched = Watched(replace(
        off(), setpoint_timeout_ms=20.0, setpoint_timeout_reaction=reaction))
    watched.convert(1000)
    assert watched.own.trips == 0  # before the first setpoint there is none to wait for
    feed(watched.own)
    watched.convert(201)
    assert watched.own.trips == 0
    watched.convert()
    assert watched.own.trips == 1 << BITS['setpoint_timeout']
    feed(watched.own)
    watched.convert()
    assert (watched.own.trips == 0) == (reaction != 'disable')


def test_a_disabled_actuator_waits_for_no_setpoint() -> None:
    watched = Watched(replace(off(), setpoint_timeout_ms=1.0))
    feed(watched.own)
    watched.state.status.is_on = 0
    watched.convert(100)
    watched.state.status.is_on = 1
    watched.convert(10)  # counted from the last conversion while disabled
    assert watched.own.trips == 0
    watched.convert()
    assert watched.own.trips == 1


@given(timeout=st.integers(1, 400))
@settings(max_examples=20, deadline=None)
def test_every_timeout_is_counted_exactly(timeout: int) -> None:
    """No time is a conversion longer or shorter because 0.1 ms is not a binary number."""
    watched = Watched(replace(off(), setpoint_timeout_ms=timeout * 0.1))
    feed(watched.own)
    watched.convert(timeout + 1)
    assert watched.own.trips == 0
    watched.convert()
    assert watched.own.trips == 1


def test_a_direction_is_inhibited_only_where_there_is_one() -> None:
    for name, levels in levels_of(defaults(Protection)).items():
        allows = 'limit' in next(
            f for f in levels.__dataclass_fields__.values()  # type: ignore[attr-defined]
            if f.name == 'reaction').metadata['names']
        assert allows == (name in (
            'end_of_stroke', 'overspeed', 'overload', 'overpressure', 'relief_open'))


def test_a_quick_stop_of_the_user_is_followed_while_a_trip_damps() -> None:
    """The stop wins: a damped load that hangs would sink."""
    watched = Watched(only('overload', trip=0.5, delay_ms=0.0, reaction='damp'))
    watched.show('overload', 6e3)
    watched.convert()
    status = watched.state.status
    status.is_stopping, status.stop.position, status.stop.velocity = 1, 0.07, 0.4
    in_force = setpoint_in_force(watched.state)
    assert (in_force.position, in_force.velocity) == (0.07, 0.4)
    status.is_stopping = 0
    assert setpoint_in_force(watched.state).position == 0.05
    status.is_returning, status.back.position = 1, 0.09     # damping wins over a way back, too
    assert setpoint_in_force(watched.state).position == 0.05
