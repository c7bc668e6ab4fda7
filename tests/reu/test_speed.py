"""Speed estimate."""

import math

from isa_ros.reu import speed
import numpy as np
import pytest
from tests.sheets import actuator_sheet


def test_it_follows_a_ramp_through_its_filter():
    """R1: a ramp's difference through 100 Hz at 1 kHz settles exponentially to its slope."""
    row = speed.speed_record(actuator_sheet('isa_v5').reu.speed)
    state = np.zeros(1, speed.SPEED_STATE).view(np.recarray)[0]
    for n in range(1, 30):
        speed.speed_step(0.3e-3 * n, row, state)
        expected = 0.3 * (1.0 - math.exp(-2.0 * math.pi * 0.1 * n))
        assert state.velocity == pytest.approx(expected, rel=1e-9)
