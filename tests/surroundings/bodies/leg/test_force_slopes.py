"""How the leg continues the forces of the other actuators into the next tick  (L16)."""

import math

from isa_ros.core.signals import LOAD_REPLY
from isa_ros.core.timebase import FORCE_WINDOWS
from isa_ros.surroundings.bodies.leg.leg import Leg, LegPose
from isa_ros.surroundings.bodies.leg.motion import LEG_STATE
import numpy as np
import pytest
from tests.legs import leg_sheet

STEP_NS = 1_000_000
H = 1e-3  # s
TIME_BYTES = 8
MIDDLES = (np.arange(FORCE_WINDOWS) + 0.5) * H / FORCE_WINDOWS
RAMP = np.arange(FORCE_WINDOWS, dtype=float)
RINGING = np.array((1.0, -1.0, 1.0, -1.0, 1.0))


def advanced(*ticks: np.ndarray) -> tuple[np.void, tuple[float, ...]]:
    """
    Return the leg's `LEG_STATE` after some ticks, and the forces that held it before.

    Each tick is the window means of three actuators, (3, FORCE_WINDOWS).
    """
    leg = Leg(leg_sheet(), LegPose(haa=math.radians(13.0), hfe=math.radians(48.0),
                                   kfe=math.radians(-95.0), foot_height=0.1), STEP_NS)
    holding = leg.actuator_forces
    for means in ticks:
        replies = np.zeros(3, LOAD_REPLY)
        replies['mean_forces'] = means
        leg.advance(replies)
    return np.frombuffer(leg.snapshot(), LEG_STATE, 1, TIME_BYTES)[0], holding


def expected_slope(means: np.ndarray, older: float) -> float:
    """Return F' of L16 from the line through the means and the mean two ticks before."""
    correlation = float(np.corrcoef(MIDDLES, means)[0, 1])
    line = float(np.polyfit(MIDDLES, means, 1)[0])
    trust = correlation ** 4
    return trust * line + (1.0 - trust) * (float(means.mean()) - older) / (2.0 * H)


@pytest.mark.parametrize('ringing', [0.0, 0.5, 2.0, 10.0])
def test_a_trend_counts_with_the_fourth_power_of_its_correlation(ringing):
    """
    L16: R from 1 (a ramp) down to 0.14, of other means in each of three ticks.

    Sums of five forces below 500 N and a division by their spread: 1e-12 of the slopes.
    """
    ticks = [offset + slope * RAMP + ringing * RINGING * slope
             for offset, slope in ((100.0, 7.0), (140.0, -5.0), (90.0, 11.0))]
    state, _ = advanced(*(np.tile(means, (3, 1)) for means in ticks))
    expected = expected_slope(ticks[2], older=float(ticks[0].mean()))
    assert state['slope'] == pytest.approx(expected, rel=1e-11)
    assert state['force'] == pytest.approx(
        float(ticks[2].mean()) + 0.5 * H * expected, rel=1e-12)


def test_the_powers_of_the_correlation_are_told_apart():
    """R^2 for R^4 would be off by more than a tenth in the cases above: they can fail."""
    means = 90.0 + 11.0 * RAMP + 2.0 * 11.0 * RINGING
    correlation = float(np.corrcoef(MIDDLES, means)[0, 1])
    assert correlation ** 2 - correlation ** 4 > 0.1


def test_the_first_tick_is_held_against_the_forces_at_rest():
    """Two ticks before the first one the actuators held the leg; equal means have no trend."""
    means = np.array((5.0, 300.0, 200.0))
    state, holding = advanced(np.tile(means[:, None], FORCE_WINDOWS))
    assert state['slope'] == pytest.approx((means - holding) / (2.0 * H))


def test_each_actuator_has_its_own_slope():
    """Only the thigh's force rises, by 5 N a window: 25 N in a tick."""
    hold = np.array(advanced()[1])[:, None] * np.ones(FORCE_WINDOWS)
    hold[1] += 5.0 * (RAMP - RAMP.mean())
    state, _ = advanced(hold)
    haa, hfe, kfe = state['slope']
    assert hfe == pytest.approx(25.0 / H, rel=1e-9)
    # the mean of equal forces of 300 N rounds to 1e-13 N, which two ticks divide by
    assert [haa, kfe] == pytest.approx([0.0, 0.0], abs=1e-9)
