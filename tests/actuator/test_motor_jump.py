"""A jump of a motor's setpoint: which trips, and which integral gain lets it pass."""

import warnings

from isa_ros.core.conditions import CONDITIONS
from isa_ros.scripting.run import load
from isa_ros.tick.trips import TripWarning
import numpy as np
import pytest

MODEL = 2.0e-4      # integral gain of the torque's loop


@pytest.mark.parametrize(('jump', 'gain', 'is_tripped'), [
    (4.0, MODEL, False), (7.0, MODEL, True), (7.0, 2.0 * MODEL, False),
    (12.0, 2.0 * MODEL, False)])
def test_twice_the_integral_gain_lets_long_jumps_pass(
        jump: float, gain: float, is_tripped: bool) -> None:
    """As docs/parts.md says, 2 kg m2 without a weight; the trip is that of the torque's error."""
    start = float(np.radians(90.0))
    run = load('winch', {'name': 'jump', 'duration_s': 1.2, 'tracks': {'drum': [
        {'t_s': 0.0, 'position': 'hold'}, {'t_s': 0.2, 'position': start + jump}]}}, changes={
        'actuators.drum.load.force': 0.0, 'actuators.drum.load.inertia': 2.0,
        'actuators.drum.parameters.reu.force.ki': gain})
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', TripWarning)
        result = run.simulate()
    names = {own.name for k, own in enumerate(CONDITIONS)
             if int(result['drum.last_trip'][-1]) >> k & 1}
    assert names == ({'force_error'} if is_tripped else set())
    if not is_tripped:
        assert result['drum.position'].max() > start + jump - 0.01
