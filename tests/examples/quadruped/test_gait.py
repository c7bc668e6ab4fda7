"""Phases of the feet, and their way through the air."""

from isa_ros.core.bound import Bound
from isa_ros.core.parameter import defaults
from isa_ros.examples.quadruped.gait import Gait, swing, swing_feet, swing_way, Swinging
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


START, END = np.array([0.1, 0.2, 0.0]), np.array([0.3, 0.1, -0.004])


def way(u: float) -> tuple[np.ndarray, np.ndarray]:
    place, speed = np.empty(3), np.empty(3)
    swing_way(u, 0.26, GAINS.lift, START, END, place, speed)
    return place, speed


def test_the_way_of_a_swing_begins_and_ends_at_rest_and_is_lifted_in_the_middle():
    for u, wanted in ((0.0, START), (1.0, END)):
        place, speed = way(u)
        assert place == pytest.approx(wanted, abs=1e-12)
        assert speed == pytest.approx(np.zeros(3), abs=1e-12)
    assert way(0.5)[0] == pytest.approx([0.2, 0.15, -0.002 + GAINS.lift], abs=1e-12)


def test_the_speed_of_a_swing_is_the_slope_of_its_way():
    for u in (0.1, 0.37, 0.5, 0.8):
        # Central difference: error of second order, 1e-12 / step of rounding.
        slope = (way(u + 1e-6)[0] - way(u - 1e-6)[0]) / (2e-6 * 0.26)
        assert way(u)[1] == pytest.approx(slope, abs=1e-6)


def test_a_swinging_foot_is_pulled_to_its_way_and_a_standing_one_is_not():
    trunk = np.array([1.0, 2.0, 0.5, 0.3, -0.2, 0.1])
    feet = np.array([[0.4, 0.2, -0.5], [0.4, -0.2, -0.4]])
    velocities = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 1.0]])
    lifted, holds = np.array([START, [1.3, 1.8, 0.0]]), np.array([[0.0, 0.0], [1.5, 1.7]])
    forces = np.full((2, 3), 7.0)
    swing_feet(trunk, np.array([0.0, 0.6]), 0.26, holds, (0.08, 0.004, 1500.0, 60.0), feet,
               velocities, lifted, np.full((3, 3), 9.0), forces)
    assert forces[0].tolist() == [7.0, 7.0, 7.0]
    end = np.array([1.5 + 0.3 * 0.4 * 0.26, 1.7 - 0.2 * 0.4 * 0.26, -0.004])
    place, speed = np.empty(3), np.empty(3)
    swing_way(0.6, 0.26, 0.08, lifted[1], end, place, speed)
    wanted = (1500.0 * (place - trunk[:3] - feet[1])
              + 60.0 * (speed - trunk[3:] - velocities[1]))
    assert forces[1] == pytest.approx(wanted, rel=1e-12, abs=0.0)
    own = Swinging(trunk, np.array([0.0, 0.6]), np.array([0.26]), holds,
                   np.array([0.08, 0.004, 1500.0, 60.0]), feet, velocities, lifted,
                   np.zeros((3, 3)), np.full((2, 3), 7.0))
    assert Bound(swing, own).run() == 0
    assert own.forces.tobytes() == forces.tobytes()


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
