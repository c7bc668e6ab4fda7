"""Commands on their way: what waits, what it changes, and what is noted of it."""

import math

from hypothesis import given, strategies as st
from isa_ros.actuator import inbox
from isa_ros.core.device import CURRENT, DISABLED, ENABLED, IMPEDANCE, SPOOL
from isa_ros.core.record import row_record, rows_of
from isa_ros.core.signals import (
    COMMAND, EVERY_KIND, HAS_ENABLE, HAS_GAINS, HAS_MODE, HAS_REFERENCE, HAS_SETPOINT)
from isa_ros.reu.cascade import REU_STATE
import numpy as np
import pytest

EVERYTHING = HAS_SETPOINT | HAS_ENABLE | HAS_GAINS
NUMBERS = st.floats(-1e6, 1e6)
GAINS = st.just(math.nan) | st.floats(0.0, 1e6)
COMMANDS = st.tuples(
    st.integers(0, EVERY_KIND), st.integers(0, 1), NUMBERS, NUMBERS, NUMBERS, GAINS, GAINS,
    st.integers(1, 6), NUMBERS)


def row(*values: float) -> np.record:
    """Return a `COMMAND` with its fields as attributes; without values, of no kind."""
    rows = np.zeros(1, COMMAND)
    if values:
        rows[0] = (*values, *[0] * (len(COMMAND.names or ()) - len(values)))
    return row_record(rows)


def reu_at(position: float, state: int = ENABLED, mode: int = IMPEDANCE) -> np.record:
    """Return a `REU_STATE` that measures a position and has a setpoint in force."""
    reu = rows_of(1, REU_STATE)[0]
    reu.measured.position = position
    setpoint = reu.setpoint
    setpoint.position, setpoint.velocity, setpoint.effort = 0.04, 0.5, 20.0
    setpoint.stiffness, setpoint.damping = 300.0, 20.0
    own = reu.status
    own.state, own.is_on = state, int(state == ENABLED)
    own.mode = own.acting = own.requested_mode = mode
    return reu


def merged(*commands: np.record) -> np.record:
    """Return what waits after these commands."""
    pending = row()
    for command in commands:
        inbox.merge(command, pending)
    return pending


def latched(pending: np.record, reu: np.record) -> np.record:
    """Let what waits take effect and return what is noted of it."""
    applied = row()
    inbox.latch(pending, reu, applied)
    return applied


def values(command: np.record) -> tuple[float, ...]:
    """Return the fields of a setpoint with its gains, from its kinds on."""
    return command.item()[:7]


def in_force(reu: np.record) -> list[float]:
    """Return position, velocity, effort, stiffness and damping."""
    own = reu.setpoint
    return [own.position, own.velocity, own.effort, own.stiffness, own.damping]


def test_of_two_setpoints_the_last_wins():
    pending = merged(row(HAS_SETPOINT, 0, 0.01, 1.0, 10.0, 100.0, 5.0),
                     row(HAS_SETPOINT, 0, 0.02, 2.0, 20.0, 200.0, 6.0))
    assert values(pending) == (HAS_SETPOINT, 0, 0.02, 2.0, 20.0, 200.0, 6.0)


def test_a_gain_that_is_left_out_keeps_the_one_that_waits():
    pending = merged(row(HAS_SETPOINT, 0, 0.01, 0.0, 0.0, 100.0, math.nan),
                     row(HAS_SETPOINT, 0, 0.02, 0.0, 0.0, math.nan, 6.0))
    assert (pending.position, pending.stiffness, pending.damping) == (0.02, 100.0, 6.0)


def test_gains_and_an_enable_that_wait_are_not_lost_to_a_setpoint():
    """Kinds add up; each keeps what it brought."""
    pending = merged(row(HAS_ENABLE, 1, 0.0, 0.0, 0.0, math.nan, math.nan),
                     row(HAS_GAINS, 0, 0.0, 0.0, 0.0, 100.0, math.nan),
                     row(HAS_SETPOINT, 0, 0.02, 2.0, 20.0, math.nan, math.nan))
    kinds, is_enabled, position, velocity, effort, stiffness, damping = values(pending)
    assert kinds == EVERYTHING
    assert (is_enabled, position, velocity, effort, stiffness) == (1, 0.02, 2.0, 20.0, 100.0)
    assert math.isnan(damping)


def test_gains_that_waited_for_an_earlier_tick_are_not_taken_again():
    """The first command after a tick begins anew, though the row still holds old numbers."""
    pending = merged(row(HAS_SETPOINT, 0, 0.01, 0.0, 0.0, 100.0, 5.0))
    latched(pending, reu_at(0.03))
    inbox.merge(row(HAS_SETPOINT, 0, 0.02, 0.0, 0.0, math.nan, math.nan), pending)
    assert math.isnan(pending.stiffness) and math.isnan(pending.damping)


def test_a_gain_that_is_nan_keeps_the_one_in_force():
    reu = reu_at(0.03)
    applied = latched(merged(row(HAS_SETPOINT, 0, 0.02, 2.0, 5.0, math.nan, 6.0)), reu)
    assert in_force(reu) == [0.02, 2.0, 5.0, 300.0, 6.0]
    assert values(applied) == (HAS_SETPOINT, 1, 0.02, 2.0, 5.0, 300.0, 6.0)


def test_gains_alone_leave_the_setpoint():
    reu = reu_at(0.03)
    applied = latched(merged(row(HAS_GAINS, 0, 9.0, 9.0, 9.0, 150.0, math.nan)), reu)
    assert in_force(reu) == [0.04, 0.5, 20.0, 150.0, 20.0]
    assert values(applied) == (HAS_GAINS, 1, 0.04, 0.5, 20.0, 150.0, 20.0)


def test_enabled_anew_it_holds_where_it_is():
    """The position measured last, at rest and without feed-forward; the gains stay."""
    reu = reu_at(0.03, state=DISABLED)
    applied = latched(merged(row(HAS_ENABLE, 1, 0.0, 0.0, 0.0, math.nan, math.nan)), reu)
    assert in_force(reu) == [0.03, 0.0, 0.0, 300.0, 20.0]
    assert values(applied) == (HAS_ENABLE, 1, 0.03, 0.0, 0.0, 300.0, 20.0)


def test_enabled_twice_it_keeps_its_setpoint():
    reu = reu_at(0.03)
    latched(merged(row(HAS_ENABLE, 1, 0.0, 0.0, 0.0, math.nan, math.nan)), reu)
    assert in_force(reu) == [0.04, 0.5, 20.0, 300.0, 20.0]


def test_enabled_with_a_setpoint_it_goes_there():
    reu = reu_at(0.03, state=DISABLED)
    latched(merged(row(HAS_ENABLE | HAS_SETPOINT, 1, 0.05, 0.1, 0.0, math.nan, math.nan)), reu)
    assert in_force(reu) == [0.05, 0.1, 0.0, 300.0, 20.0]


def test_disabled_it_keeps_its_setpoint_for_whoever_reads_it():
    reu = reu_at(0.03)
    latched(merged(row(HAS_ENABLE, 0, 0.0, 0.0, 0.0, math.nan, math.nan)), reu)
    assert in_force(reu) == [0.04, 0.5, 20.0, 300.0, 20.0]


def test_where_nothing_waits_nothing_changes_or_is_noted():
    reu, applied = reu_at(0.03), row(HAS_SETPOINT, 1, 1.0, 1.0, 1.0, 1.0, 1.0)
    before = reu.tobytes()
    inbox.latch(row(), reu, applied)
    assert reu.tobytes() == before
    assert applied.kinds == 0


def test_what_took_effect_waits_no_longer():
    pending = merged(row(EVERYTHING, 1, 0.05, 0.1, 0.0, 100.0, 5.0))
    reu = reu_at(0.03)
    assert latched(pending, reu).kinds == EVERYTHING
    assert latched(pending, reu).kinds == 0


def reference(mode: int, value: float, kinds: int = HAS_REFERENCE) -> np.record:
    """Return a command with a reference of a mode."""
    return row(kinds, 0, 0.0, 0.0, 0.0, math.nan, math.nan, mode, value)


def test_a_reference_is_taken_by_its_own_mode_only():
    """One of another mode has another unit: it is discarded and not noted as applied."""
    reu = reu_at(0.03, mode=SPOOL)
    assert latched(merged(reference(CURRENT, 1e-3)), reu).kinds == 0
    assert (reu.setpoint.reference, reu.setpoint.is_reference) == (0.0, 0.0)
    assert latched(merged(reference(SPOOL, 1e-4)), reu).kinds == HAS_REFERENCE
    assert (reu.setpoint.reference, reu.setpoint.is_reference) == (1e-4, 1.0)


def test_a_reference_that_waits_is_discarded_with_its_mode():
    """Of two modes before one tick the last wins, with its own reference or none."""
    with_mode = HAS_MODE | HAS_REFERENCE
    pending = merged(reference(SPOOL, 1e-4, with_mode), reference(CURRENT, 0.0, HAS_MODE))
    assert (pending.kinds, pending.mode) == (HAS_MODE, CURRENT)
    pending = merged(reference(SPOOL, 1e-4, HAS_MODE), reference(CURRENT, 1e-3))
    assert (pending.kinds, pending.mode) == (HAS_MODE, SPOOL)
    pending = merged(reference(SPOOL, 1e-4, with_mode), reference(SPOOL, 2e-4))
    assert (pending.kinds, pending.reference) == (with_mode, 2e-4)


def test_an_effort_after_a_reference_wins_and_the_other_way_round():
    effort = row(HAS_SETPOINT, 0, 0.0, 0.0, 1e-3, math.nan, math.nan)
    reu = reu_at(0.03, mode=CURRENT)
    latched(merged(reference(CURRENT, 2e-3), effort), reu)
    assert reu.setpoint.is_reference == 0.0
    latched(merged(effort, reference(CURRENT, 2e-3)), reu)
    assert (reu.setpoint.is_reference, reu.setpoint.reference) == (1.0, 2e-3)


@pytest.mark.parametrize('state', [DISABLED, ENABLED])
@given(commands=st.lists(COMMANDS, max_size=4))
def test_compiled_commands_equal_their_python_source(state, commands):
    """Merged one after the other, then latched: the same bytes."""
    ends = []
    for merge, latch in ((inbox.merge, inbox.latch), (inbox.merge.py_func, inbox.latch.py_func)):
        pending, reu, applied = row(), reu_at(0.03, state), row()
        for command in commands:
            merge(row(*command), pending)
        waiting = pending.tobytes()
        latch(pending, reu, applied)
        ends.append((waiting, pending.tobytes(), reu.tobytes(), applied.tobytes()))
    assert ends[0] == ends[1]


def test_an_effort_of_a_later_tick_clears_the_reference_in_force():
    """Else the mode would go on with the older of the two."""
    reu = reu_at(0.03, mode=CURRENT)
    latched(merged(reference(CURRENT, 2e-3)), reu)
    assert reu.setpoint.is_reference == 1.0
    latched(merged(row(HAS_SETPOINT, 0, 0.0, 0.0, 1e-3, math.nan, math.nan)), reu)
    assert reu.setpoint.is_reference == 0.0


@pytest.mark.parametrize(('command', 'feeds'), [
    (row(HAS_GAINS, 0, 0.0, 0.0, 0.0, 150.0, math.nan), False),
    (row(HAS_ENABLE, 1, 0.0, 0.0, 0.0, math.nan, math.nan), False),
    (row(HAS_SETPOINT, 0, 0.02, 0.0, 0.0, math.nan, math.nan), True)])
def test_only_a_setpoint_or_a_reference_feeds_the_setpoint_timeout(command, feeds):
    """Who still sends gains may have lost its planner."""
    reu = reu_at(0.03)
    reu.protection.setpoint_age = 40
    latched(merged(command), reu)
    assert reu.protection.setpoint_age == (1 if feeds else 40)
    if feeds:
        reu.protection.setpoint_age = 40
        reu.status.requested_mode = CURRENT
        latched(merged(reference(CURRENT, 1e-3)), reu)
        assert reu.protection.setpoint_age == 1
