"""The link of an actuator: when frames arrive, which are lost, and what the REU makes of it."""

from dataclasses import replace
import math
from typing import Any

from hypothesis import given, strategies as st
from isa_ros.actuator import link as links
from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.frames import DOWN, leaves, LINE, put_frame, SLOTS, take_frame
from isa_ros.actuator.group import ActuatorGroup
from isa_ros.actuator.link import link_key, link_record, LINK_STATE, LinkSheet
from isa_ros.actuator.rows import Memory
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.actuator.timing import Timing
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.core.conditions import BITS, conditions
from isa_ros.core.record import rows_of
from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_QUICK_STOP, HAS_SETPOINT
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.reu.cascade import REU_STATE
import numpy as np
import pytest
from scipy import stats
from tests.sheets import actuator_sheet, own_load, setpoint, smart_actuator

MODEL = 'isa_v5'
TICK = Timing(1_000_000, 120_000)
STEPS = 50     # of the plant in a tick
ALARM = 1e-6
"""Probability with which a check would refuse numbers that are truly random."""
N = 20_000


def link_of(**values: float) -> LinkSheet:
    """Return the sheet of a link with a cycle of a tick, unless given otherwise."""
    absent = dict.fromkeys(
        ('delay_cycles', 'jitter_us', 'loss', 'burst_loss', 'burst_frames', 'duplicates',
         'reordered', 'watchdog_ms'), 0.0) | {'cycle_ms': 1.0}
    return LinkSheet(kind='ethercat', **(absent | values))


def linked(**values: float) -> ActuatorSheet:
    """Return the sheet of an actuator behind a link."""
    return replace(actuator_sheet(MODEL), link=link_of(**values))


def actuator(sheet: ActuatorSheet | None = None, timing: Timing = TICK) -> SmartActuator:
    """Return an actuator with a mass of its own; None: without a link."""
    return smart_actuator(MODEL, 'mass', timing=timing, sheet=sheet)


def line() -> Any:
    """Return an empty `LINE`."""
    return rows_of(1, LINE)[0]


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


def test_the_watchdog_trips_at_its_step_and_recovers_with_the_next_frame():
    """Frames to 10 ms, then none: lost 3.5 ms later, at step 500 + 175; back at 20 ms."""
    own = actuator(linked(watchdog_ms=3.5))
    link, states = own.memory.constants['link'], []
    for k in range(25):
        link['loss'] = 1.0 if 11 <= k < 20 else 0.0
        own.tick()
        states.append((int(own.memory.reu['link_lost'][0]),
                       int(own.memory.reu['link_lost_step'][0])))
    assert states[:13] == [(0, 0)] * 13
    assert states[13:20] == [(1, 675)] * 7
    assert states[20:] == [(0, 675)] * 5


def test_the_watchdog_is_exact_within_a_plant_step():
    link, reu = link_record(link_of(watchdog_ms=3.5)), rows_of(1, REU_STATE)[0]
    state = rows_of(1, LINK_STATE)[0]
    state.last_frame = 500
    for watch in (links.watch, links.watch.py_func):
        for step, is_lost in ((674, 0), (675, 1), (800, 1)):
            watch(step, link, state, reu)
            assert (reu.link_lost, reu.link_lost_step) == (is_lost, 675 * is_lost)
        state.last_frame = 801
        watch(801, link, state, reu)
        assert reu.link_lost == 0
        state.last_frame, reu.link_lost_step = 500, 0


def test_a_lost_link_trips_until_the_next_frame():
    """
    Frames to 10 ms, the watchdog at 13.5 ms: it stops, though frames come again, until it stands.

    Then it goes on to its setpoint with 0.1 m/s. The REU looks at its conversions, every 5 plant
    steps from step 1 on: the first later than step 675 is 676.
    """
    own = actuator(linked(watchdog_ms=3.5))
    link = own.memory.constants['link']
    own.accept(setpoint(position=0.06))
    trips = []
    for k in range(25):
        link['loss'] = 1.0 if 11 <= k < 20 else 0.0
        own.tick()
        trips.append(conditions(own.sample.trips))
    assert trips == [[]] * 13 + [['link_lost']] * 7 + [[]] * 5
    protection = own.memory.reu['protection'][0]
    assert protection['trip_since'][BITS['link_lost']] == 676
    for _ in range(60):
        own.tick()
        assert own.sample.position < 0.053
    assert not own.memory.reu['status'][0]['is_stopping']
    for _ in range(120):
        before = float(own.sample.position_reference)
        own.tick()
        assert own.sample.position_reference - before < 1.001e-4  # 0.1 m/s for a tick of 1 ms
    assert own.sample.position_reference == 0.06


def test_a_link_without_watchdog_is_never_lost():
    own = actuator(linked(loss=1.0))
    for _ in range(20):
        own.tick()
    assert own.memory.reu['link_lost'][0] == 0


def exchanged(is_compiled: bool) -> bytes:
    """Return a memory after 30 ticks of frames alone, by kernels or by their Python source."""
    own = actuator(linked(**LOSSY))
    memory = Memory(*(rows.view(np.recarray) if rows.dtype.names else rows for rows in own.memory))
    kernels = [links.hand_over, links.exchange_frames, links.send_sample, links.receive_samples]
    hand_over, exchange, send, receive = (
        kernels if is_compiled else [kernel.py_func for kernel in kernels])
    for k in range(30):
        own.accept(setpoint(position=0.05 + 1e-4 * k))
        hand_over(50 * k, 0, memory)
        for step in range(STEPS * k, STEPS * (k + 1)):
            memory.samples.position[0] = step
            is_sampled = step > STEPS * k and step % (STEPS // 2) == 0
            exchange(step, is_sampled, 0, memory)
        send(STEPS * (k + 1), 0, memory)
        receive(STEPS * (k + 1), 0, memory)
    assert memory.observed.position[0] > 0.0 and memory.applied.due_step[0] > 0
    return b''.join(rows.tobytes() for rows in memory)


def test_compiled_frames_equal_their_python_source():
    assert exchanged(True) == exchanged(False)


LOSSY = {'cycle_ms': 0.5, 'delay_cycles': 2, 'jitter_us': 300.0, 'loss': 0.3, 'watchdog_ms': 3.0}


def driven(own: SmartActuator, ticks: range) -> list[bytes]:
    """Advance with a setpoint at every tick; return what is sent, applied and observed."""
    seen = []
    for k in ticks:
        own.accept(setpoint(position=0.05 + 1e-4 * (k % 7)))
        own.tick()
        memory = own.memory
        seen.append(b''.join(rows.tobytes() for rows in (
            memory.samples, memory.observed, memory.applied, memory.sent, memory.reu)))
    return seen


def test_a_restored_link_goes_on_with_its_frames_on_their_way():
    whole, first = actuator(linked(**LOSSY)), actuator(linked(**LOSSY))
    expected = driven(whole, range(60))
    driven(first, range(31))
    assert first.memory.links['down']['count'][0] > 0
    second = actuator(linked(**LOSSY))
    second.restore(first.snapshot())
    assert driven(second, range(31, 60)) == expected[31:]
    whole.start(*[0.5 * actuator_sheet(MODEL).plant.drive.stroke, 0.0, 20.7e6, 0.0])
    assert whole.memory.links['down']['count'][0] == 0


def test_a_snapshot_has_frames_only_behind_a_link():
    direct, behind = actuator(), actuator(linked())
    frames = sum(getattr(behind.memory, name).nbytes for name in (
        'links', 'sent', 'outbox', 'commands_sent', 'samples_sent', 'observed'))
    frames += behind.tuning.nbytes - direct.tuning.nbytes   # what is tuned is on its way too
    assert behind.tuning.nbytes > direct.tuning.nbytes
    assert len(behind.snapshot()) - len(direct.snapshot()) == frames


@pytest.mark.parametrize('field, value', [('first', SLOTS), ('first', -1), ('count', 99)])
def test_a_saved_state_with_an_impossible_line_is_refused(field, value):
    """Its slots would lie in other memory."""
    own = actuator(linked())
    own.memory.links['up'][field] = value
    with pytest.raises(ConfigError, match=f'{field} = {value} of a link, must be 0 to'):
        own.restore(own.snapshot())


def test_actuators_of_one_group_have_the_frames_that_they_have_alone():
    load, x = own_load(MODEL, 'mass'), 0.05
    configs = [ActuatorConfig(name, MODEL, 'default', sheet, load, x) for name, sheet in (
        ('hip', linked(**LOSSY)), ('knee', actuator_sheet(MODEL)), ('toe', linked(**LOSSY)))]
    group = ActuatorGroup(configs, TICK)
    alone = [SmartActuator(config, TICK) for config in configs]
    ports = group._memory.ports.copy()
    for k in range(40):
        for own in (*group.actuators, *alone):
            own.accept(setpoint(position=0.05 + 1e-4 * (k % 7)))
        group.advance(ports)
        for own in alone:
            own.tick()
        for name in ('observed', 'applied', 'sent', 'links'):
            assert getattr(group._memory, name).tobytes() == b''.join(
                getattr(own.memory, name).tobytes() for own in alone), (k, name)
    hip, _, toe = group.observed['age']
    assert {hip, toe} != {0.0} and group._memory.links['down'][0] != group._memory.links['down'][2]


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


DEAD = {'link.loss': 1.0}


def asked(kinds: int, is_enabled: int = 0) -> np.void:
    command: np.void = np.zeros(1, COMMAND)[0]
    command['kinds'], command['is_enabled'] = kinds, is_enabled
    return command


def test_a_dead_link_answers_no_success_and_its_old_commands_do_not_act():
    """The quick stop of a broken cable does not come 100 ms after it is mended."""
    own = actuator(linked(cycle_ms=1.0, delay_cycles=1.0, watchdog_ms=10.0))
    for _ in range(20):
        own.tick()
    done, answer = own.request(asked(HAS_ENABLE, 1), 'enabled')
    assert done and answer.startswith('enabled: handed to the link at t = 0.020000 s')
    own.tick()
    own.tick()
    own.tune(DEAD)
    for _ in range(12):
        own.tick()
    state, observed = own.memory.reu[0]['status']['state'], own.memory.observed[0]
    assert observed['is_stale'] == 1.0 and observed['age'] >= 0.01
    done, answer = own.request(asked(HAS_QUICK_STOP), 'quick stop')
    assert not done and answer.startswith('quick stop: the link is lost: the last sample is 0.01')
    for _ in range(11):
        own.tick()
    assert observed['commands_dropped'] == 1.0 and own.memory.outbox[0]['kinds'] == 0
    own.tune({'link.loss': 0.0})
    for _ in range(20):
        own.tick()
    assert own.memory.reu[0]['status']['state'] == state, 'no quick stop'
    assert observed['is_stale'] == 0.0 and observed['age'] < 0.01


@pytest.mark.parametrize('fresh', [True, False])
def test_a_fresh_setpoint_survives_where_an_old_request_is_dropped(fresh):
    """Each has its own age: a setpoint every tick does not carry an old quick stop along."""
    own = actuator(linked(cycle_ms=1.0, delay_cycles=1.0, watchdog_ms=10.0))
    own.tune(DEAD)
    own.accept(asked(HAS_QUICK_STOP))
    for k in range(15):
        if fresh or k == 0:
            own.accept(setpoint(position=0.05))
        own.tick()
    assert int(own.memory.outbox[0]['kinds']) == (HAS_SETPOINT if fresh else 0)
    assert own.memory.observed[0]['commands_dropped'] == (1.0 if fresh else 2.0)


def test_without_a_watchdog_a_command_waits_as_long_as_it_takes():
    own = actuator(linked(cycle_ms=1.0, delay_cycles=1.0, watchdog_ms=0.0))
    own.tune(DEAD)
    own.accept(asked(HAS_QUICK_STOP))
    for _ in range(40):
        own.tick()
    assert int(own.memory.outbox[0]['kinds']) == HAS_QUICK_STOP
    assert own.memory.observed[0]['is_stale'] == 1.0, 'older than ten cycles'


def test_lost_frames_are_counted_each_way():
    own = actuator(linked(cycle_ms=1.0, delay_cycles=1.0, loss=0.3))
    for _ in range(200):
        own.tick()
    link, observed = own.memory.links[0], own.memory.observed[0]
    assert 30 < link['up']['lost'] < 90 and 30 < link['down']['lost'] < 90
    assert observed['frames_lost_up'] == link['up']['lost']
    assert 0 <= link['down']['lost'] - observed['frames_lost_down'] < 10


def test_a_frozen_reu_sends_no_frames_and_takes_none():
    own = actuator(linked(cycle_ms=1.0, delay_cycles=1.0, watchdog_ms=10.0))
    for _ in range(10):
        own.tick()
    own.tune({'reu.frozen': 1.0})
    lost = int(own.memory.links[0]['down']['lost'])
    for _ in range(30):
        own.accept(setpoint(position=0.03))
        own.tick()
    assert own.memory.observed[0]['is_stale'] == 1.0
    assert own.memory.observed[0]['age'] == pytest.approx(0.03, abs=2e-3)
    assert own.memory.links[0]['down']['lost'] > lost + 25
    assert not own.memory.observed[0]['trips'], 'its watchdog has acted, and cannot tell'
    own.tune({'reu.frozen': 0.0})
    for _ in range(4):
        own.tick()
    assert conditions(own.memory.observed[0]['trips']) == ['watchdog']
