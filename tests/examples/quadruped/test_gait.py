"""Phases of the feet, and their way through the air."""

from isa_ros.core.parameter import defaults
from isa_ros.examples.quadruped.gait import Gait
from isa_ros.examples.quadruped.parameters import TrotGains
import numpy as np
import pytest

GAINS = defaults(TrotGains)
STRIDE = 1.0 / GAINS.frequency


def test_all_feet_stand_until_steps_are_wanted():
    gait = Gait(GAINS)
    gait.advance(10.0, False)
    assert gait.is_standing.all() and not gait.is_stepping


def test_diagonal_feet_step_together_and_stand_for_their_duty():
    gait = Gait(GAINS)
    gait.advance(0.0, True)
    stood = []
    for _ in range(2000):
        gait.advance(2.0 * STRIDE / 2000, True)
        stood.append(gait.is_standing.copy())
        assert gait.is_standing[0] == gait.is_standing[3]
        assert gait.is_standing[1] == gait.is_standing[2]
        assert gait.is_standing[:2].any()   # duty >= 0.5: never in the air
    assert np.mean(stood, axis=0) == pytest.approx(GAINS.duty, abs=1e-3)


def test_a_swing_goes_from_nothing_to_all_in_its_time():
    gait = Gait(GAINS)
    gait.advance(0.0, True)
    gait.advance(gait.stand_s + 0.25 * gait.swing_s, True)
    assert not gait.is_standing[0]
    assert gait.progress[0] == pytest.approx(0.25)
    assert gait.progress[1] == 0.0


def test_it_stops_only_while_all_feet_stand():
    gait = Gait(GAINS)
    gait.advance(0.0, True)
    gait.advance(gait.stand_s + 0.1 * gait.swing_s, True)
    for _ in range(3000):
        gait.advance(STRIDE / 1000, False)
        if not gait.is_stepping:
            break
        assert not gait.is_standing.all()
    assert not gait.is_stepping and gait.is_standing.all()
    gait.advance(0.1, False)
    assert gait.is_standing.all()
    gait.advance(0.001, True)
    assert gait.is_stepping and gait.stride == 0.0


def test_the_way_of_a_swing_begins_and_ends_at_rest_and_is_lifted_in_the_middle():
    gait = Gait(GAINS)
    start, end = np.array([0.1, 0.2, 0.0]), np.array([0.3, 0.1, -0.004])
    for u, place in ((0.0, start), (1.0, end)):
        there, speed = gait.swing(u, start, end)
        assert there == pytest.approx(place, abs=1e-12)
        assert speed == pytest.approx(np.zeros(3), abs=1e-12)
    there, _ = gait.swing(0.5, start, end)
    assert there == pytest.approx([0.2, 0.15, -0.002 + GAINS.lift], abs=1e-12)


def test_the_speed_of_a_swing_is_the_slope_of_its_way():
    gait = Gait(GAINS)
    start, end = np.array([0.1, 0.2, 0.0]), np.array([0.3, 0.1, -0.004])
    for u in (0.1, 0.37, 0.5, 0.8):
        step = 1e-6
        before, after = (gait.swing(u + d, start, end)[0] for d in (-step, step))
        _, speed = gait.swing(u, start, end)
        # Central difference: error of second order, 1e-12 / step of rounding.
        assert speed == pytest.approx((after - before) / (2.0 * step * gait.swing_s), abs=1e-6)


def test_a_state_is_restored():
    gait, other = Gait(GAINS), Gait(GAINS)
    for _ in range(7):
        gait.advance(0.05, True)
    other.restore(gait.state())
    for own in (gait, other):
        own.advance(0.013, True)
    assert other.state() == gait.state()
    assert other.progress.tolist() == gait.progress.tolist()
    still = Gait(GAINS)
    still.restore(Gait(GAINS).state())
    assert still.is_standing.all()
