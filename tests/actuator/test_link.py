"""The link of an actuator: when frames arrive, which are lost, and what the REU makes of it."""

import math

from hypothesis import given, strategies as st
from isa_ros.actuator.frames import DOWN, leaves, put_frame, SLOTS, take_frame
from isa_ros.actuator.link import link_key, link_record
from isa_ros.actuator.timing import Timing
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.errors import ConfigError, ParameterError
import numpy as np
import pytest
from scipy import stats
from tests.actuator.linked import actuator, line, link_of, linked, STEPS
from tests.sheets import setpoint

ALARM = 1e-6
"""Probability with which a check would refuse numbers that are truly random."""
N = 20_000


def sent_frames(n: int, **values: float) -> tuple[np.ndarray, np.ndarray]:
    """Return steps of departure and of arrival of ``n`` frames, one a ms; -1: lost."""
    link, own, key = link_record(link_of(**values)), line(), np.uint64(link_key(5, 'knee'))
    sent, due = STEPS * np.arange(n), np.full(n, -1)
    for k, step in enumerate(sent):
        slot = put_frame(step, DOWN, key, link, own)
        if slot >= 0:
            due[k] = own.due[slot]
            own.count = 0
    return sent, due


def test_without_loss_delay_and_jitter_it_changes_no_bit():
    """Of sample, force on the load and state, with setpoints at every third tick."""
    direct, behind = actuator(), actuator(linked())
    for k in range(150):
        if k % 3 == 0:
            for own in (direct, behind):
                own.accept(setpoint(position=0.05 + 1e-5 * k))
        for own in (direct, behind):
            own.tick()
        for name in ('samples', 'observed', 'replies', 'continuous', 'reu'):
            assert getattr(direct.memory, name).tobytes() == getattr(
                behind.memory, name).tobytes(), (k, name)


@pytest.mark.parametrize('delay', [0, 1, 3, 8])
def test_a_command_takes_effect_after_the_delay(delay):
    """Sent in the tick that begins at step 200: with its frame, ``delay`` cycles later."""
    own = actuator(linked(delay_cycles=delay))
    found = []
    for k in range(20):
        if k == 4:
            own.accept(setpoint(position=0.06))
        own.tick()
        if own.applied is not None:
            found.append((k, int(own.applied.due_step), float(own.applied.position)))
    assert found == [(4 + delay, (4 + delay) * STEPS, 0.06)]


def test_a_command_waits_for_the_next_cycle():
    """Cycles of 4 ms: what is sent 1 ms after a boundary leaves 3 ms later."""
    own = actuator(linked(cycle_ms=4.0))
    for _ in range(5):
        own.tick()
    own.accept(setpoint(position=0.06))
    for _ in range(3):
        own.tick()
        assert own.applied is None
    own.tick()
    assert own.applied is not None and own.applied.due_step == 8 * STEPS


def test_cycles_need_not_be_whole_plant_steps():
    """Every 0.25 ms, 12.5 steps: frames leave at the first step since; delays are exact."""
    link, own = link_record(link_of(cycle_ms=0.25, delay_cycles=1)), line()
    for leaves_at in (leaves, leaves.py_func):
        assert [step for step in range(101) if leaves_at(step, link)] == [
            0, 13, 25, 38, 50, 63, 75, 88, 100]
    for step in (0, 13, 25, 38):
        put_frame(step, DOWN, np.uint64(0), link, own)
    assert own.due[:4].tolist() == [13, 25, 38, 50]


@pytest.mark.parametrize('cycle_ms, delay', [(0.4, 3), (0.24, 5)])
def test_a_command_acts_inside_a_tick_as_at_the_start_of_one(cycle_ms, delay):
    """
    At plant steps, not at ticks only: ticks of 5 ms, delays of 1.2 ms.

    The same plant in ticks of 0.1 ms without a link, the setpoint at 1.2 ms, gives equal bits.
    """
    long = actuator(linked(cycle_ms=cycle_ms, delay_cycles=delay), Timing(5_000_000, 0))
    short = actuator(timing=Timing(100_000, 0))
    long.accept(setpoint(position=0.06))
    long.tick()
    assert long.applied is not None and long.applied.due_step * PLANT_STEP == pytest.approx(
        1.2e-3, rel=1e-12, abs=0.0)
    for k in range(50):
        if k == 12:
            short.accept(setpoint(position=0.06))
        short.tick()
    for name in ('plant', 'load'):
        assert (long.memory.continuous[0][name].tobytes()
                == short.memory.continuous[0][name].tobytes())
    assert long.sample.force_reference == short.sample.force_reference != 0.0


@pytest.mark.parametrize('delay', [0, 2])
def test_listeners_have_the_sample_of_a_delay_ago(delay):
    own = actuator(linked(delay_cycles=delay))
    seen = [own.memory.samples.copy()]
    for k in range(1, 30):
        own.accept(setpoint(position=0.05 + 1e-4 * k))
        own.tick()
        seen.append(own.memory.samples.copy())
        observed = own.memory.observed[0].copy()
        sampled = max(0, k - delay)
        assert observed['age'] == (k - sampled) * STEPS * PLANT_STEP
        observed['age'] = 0.0
        assert observed.tobytes() == seen[sampled].tobytes()


def test_a_frame_that_leaves_inside_a_tick_has_the_values_of_that_instant():
    """Cycles of 0.5 ms and one of delay: listeners have what a tick of 0.5 ms would sample."""
    own = actuator(linked(cycle_ms=0.5, delay_cycles=1), Timing(1_000_000, 0))
    fine = actuator(timing=Timing(500_000, 0))
    for each in (own, fine):
        each.accept(setpoint(position=0.055))
    # The setpoint comes a cycle later behind the link.
    fine_pending = fine.memory.pending.copy()
    fine.memory.pending['kinds'] = 0
    fine.tick()
    fine.memory.pending[:] = fine_pending
    for _ in range(10):
        own.tick()
        for name in ('position', 'velocity', 'force', 'pressure_a', 'spool', 'current'):
            assert own.memory.observed[name] == fine.memory.samples[name], name
        fine.tick()
        fine.tick()
    assert own.memory.observed['age'] == 25 * PLANT_STEP


def test_lost_frames_keep_setpoint_and_sample_and_the_command_goes_with_the_next():
    own = actuator(linked(loss=1.0))
    first = own.memory.samples.copy()
    own.accept(setpoint(position=0.06))
    for k in range(1, 6):
        own.tick()
        assert own.applied is None
        assert own.memory.observed['position'] == first['position']
        assert own.memory.observed['age'][0] == k * STEPS * PLANT_STEP
    own.memory.constants['link']['loss'] = 0.0
    own.tick()
    assert own.applied is not None and own.applied.position == 0.06
    assert own.memory.observed['age'][0] == 0.0
    own.tick()
    assert own.applied is None


def test_the_newest_command_wins_and_kinds_add_up_while_frames_are_lost():
    own = actuator(linked(loss=1.0))
    for position, stiffness in ((0.06, 300.0), (0.07, math.nan)):
        own.accept(setpoint(position=position, stiffness=stiffness))
        own.tick()
    own.memory.constants['link']['loss'] = 0.0
    own.tick()
    applied = own.applied
    assert applied is not None and (applied.position, applied.stiffness) == (0.07, 300.0)


@pytest.mark.parametrize('loss', [0.01, 0.3])
def test_as_many_frames_are_lost_as_configured(loss):
    _, due = sent_frames(N, loss=loss)
    n_lost = int((due < 0).sum())
    assert stats.binomtest(n_lost, N, loss).pvalue > ALARM


def test_jitter_is_uniform_and_rounded_up_to_plant_steps():
    """100 us are 5 plant steps: each of 1 to 5 comes with probability 1/5."""
    sent, due = sent_frames(N, jitter_us=100.0)
    late = due - sent
    assert set(late.tolist()) == {1, 2, 3, 4, 5}
    assert stats.chisquare(np.bincount(late)[1:]).pvalue > ALARM
    halves = late[:-1], late[1:]
    assert abs(np.corrcoef(*halves)[0, 1]) < stats.norm.isf(ALARM / 2) / math.sqrt(N)


def test_seed_name_and_direction_decide_and_nothing_else():
    def lot(seed: int, name: str, channel: int) -> list[int]:
        link, own = link_record(link_of(loss=0.5)), line()
        return [put_frame(step, channel, np.uint64(link_key(seed, name)), link, own) < 0
                for step in range(SLOTS)]
    drawn = [lot(0, 'hip', 0), lot(1, 'hip', 0), lot(0, 'knee', 0), lot(0, 'hip', 1)]
    assert lot(0, 'hip', 0) == drawn[0]
    assert len({tuple(one) for one in drawn}) == 4


SHARE = st.just(0.0) | st.floats(1e-9, 1.0)     # as a sheet may have it
CHANGES = st.tuples(st.integers(0, 8), SHARE, SHARE)


@given(st.lists(CHANGES, min_size=1, max_size=60))
def test_no_frame_overtakes_another_one_and_kernels_equal_their_source(changes):
    """Also while delay, jitter and loss change: frames arrive in order, none before its time."""
    lines, logs = [line(), line()], []
    key = np.uint64(link_key(3, 'knee'))
    for own, (put, take) in zip(lines, (
            (put_frame, take_frame), (put_frame.py_func, take_frame.py_func))):
        log = []
        for k, (delay, jitter, loss) in enumerate(changes):
            link = link_record(link_of(delay_cycles=delay, jitter_us=1000.0 * jitter, loss=loss))
            log.append((put(k * STEPS, DOWN, key, link, own), int(own.count)))
            for step in range(k * STEPS, (k + 1) * STEPS, 10):
                due = own.due.copy()
                while (slot := take(step, own)) >= 0:
                    log.append((int(own.sent[slot]), int(due[slot]), step))
        logs.append(log)
    assert logs[0] == logs[1]
    assert lines[0].tobytes() == lines[1].tobytes()
    taken = [entry for entry in logs[0] if len(entry) == 3]
    assert all(sent <= due <= step < due + 10 for sent, due, step in taken)
    assert [sent for sent, *_ in taken] == sorted({sent for sent, *_ in taken})
    assert all(count <= 10 for slot, count in (e for e in logs[0] if len(e) == 2))


def test_a_delay_that_changes_during_a_run_keeps_the_order_of_the_frames():
    """Longer from tick 10 on: two ticks bring no frame. Shorter from 20 on: tick 22 has three."""
    own = actuator(linked(delay_cycles=1.0))
    applied = []
    for k in range(30):
        if k in (10, 20):
            own.tune({'link.delay_cycles': 3.0 if k == 10 else 1.0})
        own.accept(setpoint(position=0.05 + 1e-5 * k))
        own.tick()
        applied.append(round((own.sample.position_reference - 0.05) / 1e-5))
    assert applied[1:] == [
        *range(10), 9, 9, *range(10, 19), *range(21, 29)]


def test_a_jitter_that_changes_during_a_run_makes_frames_late():
    own = actuator(linked())
    due = []
    for jitter_us in (0.0, 800.0, 0.0):
        own.tune({'link.jitter_us': jitter_us})
        for _ in range(20):
            own.accept(setpoint(position=0.06))
            own.tick()
            due.append(int(own.applied.due_step) % STEPS)
    assert set(due[1:20]) == set(due[41:]) == {0} and 0 < max(due[20:40]) <= 40


@pytest.mark.parametrize(('values', 'message'), [
    ({'link.delay_cycles': 4.0}, 'watchdog_ms = 3.5 ms, must be > 4 ms'),
    ({'link.delay_cycles': 0.5}, 'delay_cycles = 0.5 cycles, must be a whole number'),
    ({'link.jitter_us': 1500.0}, 'jitter_us = 1500 us, must be <= cycle_ms = 1 ms')])
def test_a_link_is_not_changed_into_one_that_cannot_be(values, message):
    own = actuator(linked(watchdog_ms=3.5))
    with pytest.raises(ConfigError, match=message):
        own.tune(values)


@pytest.mark.parametrize('values, message', [
    ({'cycle_ms': 0.01}, 'cycle_ms = 0.01 ms, must be >= the plant step 0.02 ms'),
    ({'delay_cycles': 1.5}, 'delay_cycles = 1.5 cycles, must be a whole number'),
    ({'delay_cycles': 9.0}, 'delay_cycles = 9 cycles, must be <= 8 cycles'),
    ({'jitter_us': 1001.0}, 'jitter_us = 1001 us, must be <= cycle_ms = 1 ms'),
    ({'loss': 1.1}, 'loss = 1.1, must be <= 1'),
    ({'watchdog_ms': 1.0}, 'watchdog_ms = 1 ms, must be > 1 ms, the longest time without'),
    ({'watchdog_ms': 3.2, 'delay_cycles': 3.0, 'jitter_us': 200.0}, 'must be > 3.2 ms')])
def test_what_no_link_can_have_is_refused(values, message):
    with pytest.raises(ParameterError) as refused:
        link_of(**values)
    assert message in str(refused.value)


def test_the_record_is_in_nanoseconds():
    record = link_record(link_of(
        cycle_ms=0.5, delay_cycles=3, jitter_us=50.0, loss=0.25, burst_loss=0.2, burst_frames=5.0,
        duplicates=0.3, reordered=0.4, watchdog_ms=10.0))
    assert record.item() == (
        1, 500_000, 1_500_000, 10_000_000, 50_000.0, 0.25, 0.05, 0.2, 0.3, 0.4)


def test_a_cycle_of_the_tick_needs_a_run():
    with pytest.raises(ConfigError, match='link.cycle_ms = 0 ms is the tick of a run'):
        link_record(link_of(cycle_ms=0.0))
