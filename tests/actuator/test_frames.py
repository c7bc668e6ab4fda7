"""Losses in bursts, duplicates and frames that overtake each other, on one direction of a link."""

from isa_ros.actuator.frames import (
    burst_rates, copy_frame, DOWN, put_frame, SLOTS, take_frame, UP)
from isa_ros.actuator.link import link_key, link_record
from isa_ros.errors import ParameterError
import numpy as np
import pytest
from scipy import stats
from tests.actuator.linked import actuator, line, link_of, linked, STEPS
from tests.actuator.test_link import ALARM, N
from tests.sheets import setpoint

KEY = np.uint64(link_key(5, 'knee'))


def losses(n: int = N, channel: int = DOWN, **values: float) -> np.ndarray:
    """Return which of ``n`` frames are lost, one a ms."""
    link, own, lost = link_record(link_of(**values)), line(), np.zeros(n, bool)
    for k in range(n):
        lost[k] = put_frame(STEPS * k, channel, KEY, link, own) < 0
        own.count = 0
    assert own.lost == lost.sum()
    return lost


def lengths(lost: np.ndarray) -> np.ndarray:
    """Return the lengths of all runs of losses."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], lost, [0]])))
    return edges[1::2] - edges[::2]


@pytest.mark.parametrize('share, frames', [(0.05, 4.0), (0.2, 10.0), (0.5, 1.0), (0.1, 1.0)])
def test_bursts_take_their_share_and_have_their_mean_length(share, frames):
    """
    Lengths are geometric with r = 1/frames: their mean has a deviation of sqrt(1 - r)/r/sqrt(m).

    A share of a two-state chain has the variance share (1 - share)(1 + q)/(1 - q)/n with
    q = 1 - p - r.
    """
    lost = losses(burst_loss=share, burst_frames=frames)
    p, r = burst_rates(share, frames)
    found, far = lengths(lost), stats.norm.isf(ALARM / 2.0)
    assert abs(found.mean() - frames) <= far * np.sqrt(1.0 - r) / r / np.sqrt(len(found)) + 1e-9
    q = 1.0 - p - r
    sigma = np.sqrt(share * (1.0 - share) * (1.0 + q) / (1.0 - q) / N)
    assert abs(lost.mean() - share) <= far * sigma + 1.0 / N
    assert abs(p / (p + r) - share) < 1e-12


def test_losses_beside_bursts_are_those_of_a_good_line():
    """Both together lose what either loses: the single ones are the same frames."""
    single, bursts = losses(loss=0.05), losses(burst_loss=0.2, burst_frames=5.0)
    assert (losses(loss=0.05, burst_loss=0.2, burst_frames=5.0) == (single | bursts)).all()
    assert (single & ~bursts).sum() > 500


def test_directions_have_bursts_of_their_own_and_all_may_be_lost():
    values = {'burst_loss': 0.2, 'burst_frames': 5.0}
    assert (losses(**values) != losses(channel=UP, **values)).sum() > 1000
    assert losses(n=50, burst_loss=1.0).all()


def test_a_burst_ends_when_bursts_are_switched_off():
    bad, good, own = link_record(link_of(burst_loss=1.0)), link_record(link_of()), line()
    assert put_frame(0, DOWN, KEY, bad, own) < 0 and own.is_bad == 1
    assert put_frame(STEPS, DOWN, KEY, good, own) >= 0 and own.is_bad == 0


def arrivals(n: int, **values: float) -> list[tuple[int, int]]:
    """Return (plant step of arrival, number of the frame) of ``n`` frames, in their order."""
    link, own, found = link_record(link_of(**values)), line(), []
    numbers = [-1] * SLOTS
    for step in range(STEPS * (n + 12)):
        if step % STEPS == 0 and step < STEPS * n:
            slot = put_frame(step, DOWN, KEY, link, own)
            if slot >= 0:
                numbers[slot] = step // STEPS
                copy = copy_frame(step, DOWN, KEY, link, own, slot)
                if copy >= 0:
                    numbers[copy] = numbers[slot]
        slot = take_frame(step, own)
        while slot >= 0:
            found.append((step, numbers[slot]))
            slot = take_frame(step, own)
    assert own.count == 0
    return found


def test_without_these_keys_frames_arrive_once_and_in_order():
    assert arrivals(100, delay_cycles=2.0) == [(STEPS * (k + 2), k) for k in range(100)]


def test_a_duplicate_arrives_again_a_cycle_later_after_the_next_frame():
    assert arrivals(3, duplicates=1.0) == [
        (0, 0), (STEPS, 0), (STEPS, 1), (2 * STEPS, 1), (2 * STEPS, 2), (3 * STEPS, 2)]
    found = [number for _, number in arrivals(1000, duplicates=0.3)]
    twice = len(found) - 1000
    assert stats.binomtest(twice, 1000, 0.3).pvalue > ALARM and sorted(set(found)) == list(
        range(1000))


def test_a_frame_that_is_held_back_is_overtaken_by_the_next_one():
    """A cycle and a half late; the others are on time."""
    found = arrivals(1000, reordered=0.2)
    late = [(step, k) for step, k in found if step != STEPS * k]
    assert {step - STEPS * k for step, k in late} == {3 * STEPS // 2}
    assert stats.binomtest(len(late), 1000, 0.2).pvalue > ALARM
    order = [k for _, k in found]
    assert order != sorted(order) and sorted(order) == list(range(1000))


def test_the_longest_way_with_everything_fits_into_the_line():
    found = arrivals(400, delay_cycles=8.0, jitter_us=1000.0, reordered=0.5, duplicates=1.0)
    assert len(found) == 800


def test_frames_equal_their_python_source():
    values = {'loss': 0.1, 'burst_loss': 0.2, 'burst_frames': 3.0, 'duplicates': 0.3,
              'reordered': 0.3, 'delay_cycles': 2.0, 'jitter_us': 700.0}
    link, rows = link_record(link_of(**values)), []
    for put, copy, take in ((put_frame, copy_frame, take_frame), (
            put_frame.py_func, copy_frame.py_func, take_frame.py_func)):
        own, states = line(), []
        for step in range(0, 200 * STEPS, STEPS):
            slot = put(step, DOWN, KEY, link, own)
            if slot >= 0:
                copy(step, DOWN, KEY, link, own, slot)
            while take(step, own) >= 0:
                pass
            states.append(own.tobytes())
        rows.append(states)
    assert rows[0] == rows[1]


def test_the_reu_follows_what_arrives_last():
    """Of two setpoints the first is held back, or comes a second time: it wins over the second."""
    for values in ({'duplicates': 1.0}, {'reordered': 1.0}):
        own = actuator(linked(**values))
        if 'reordered' in values:   # only the first one is late
            own.accept(setpoint(position=0.06))
            own.tick()
            own.tune({'link.reordered': 0.0})
            own.accept(setpoint(position=0.07))
            own.tick()
            assert own._reu.setpoint.position == 0.06
            continue
        positions = []
        for position in (0.06, 0.07):
            own.accept(setpoint(position=position))
            own.tick()
            positions.append(float(own._reu.setpoint.position))
        own.tick()
        assert positions[0] == 0.06 and own._reu.setpoint.position == 0.07


def test_a_saved_state_goes_on_in_a_burst_with_frames_out_of_order():
    values = {'burst_loss': 0.3, 'burst_frames': 4.0, 'duplicates': 0.3, 'reordered': 0.3,
              'delay_cycles': 2.0}
    own, twin = actuator(linked(**values)), actuator(linked(**values))
    lost = 0
    for k in range(60):
        own.accept(setpoint(position=0.05 + 1e-4 * k))
        own.tick()
        if own.memory.links['down']['is_bad'][0] and not lost:
            lost = k
            twin.restore(own.snapshot())
        elif lost:
            twin.accept(setpoint(position=0.05 + 1e-4 * k))
            twin.tick()
            assert twin.snapshot() == own.snapshot()
    assert 0 < lost < 50


@pytest.mark.parametrize(('values', 'message'), [
    ({'burst_loss': 0.5}, 'burst_frames = 0 frames, must be >= 1 frames with burst_loss = 0.5'),
    ({'burst_loss': 0.8, 'burst_frames': 3.0}, 'burst_frames = 3 frames, must be >= 4 frames'),
    ({'burst_loss': 1.1}, 'burst_loss = 1.1, must be <= 1'),
    ({'duplicates': -0.1}, 'duplicates = -0.1, must be >= 0'),
    ({'reordered': 0.1, 'watchdog_ms': 2.5}, 'watchdog_ms = 2.5 ms, must be > 2.5 ms')])
def test_what_no_line_can_do_is_refused(values, message):
    with pytest.raises(ParameterError, match=message):
        link_of(**values)
