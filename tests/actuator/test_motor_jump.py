"""Jumps of a motor's setpoint: which trip, in both directions, with cold and with warm oil."""

import warnings

from isa_ros.core.conditions import CONDITIONS
from isa_ros.scripting.run import load
from isa_ros.tick.trips import TripWarning
import numpy as np
import pytest

OIL = {'density': 860.0, 'specific_heat': 1970.0, 'viscosity_at_40_cst': 46.0,
       'viscosity_at_100_cst': 6.8, 'compressibility_per_k': 4.5e-3}


def bath(celsius: float) -> dict[str, object]:
    """Return a section of a motor whose oil keeps a temperature."""
    return {'kind': 'lumped', 'start_celsius': celsius, 'supply_celsius': celsius,
            'ambient_celsius': celsius, 'body_heat_capacity': 1e6, 'oil_to_body': 1e5,
            'body_to_air': 0.0, 'laminar_share': 1.0, 'oil': OIL}


def jumped(jump: float, **parameters: object) -> tuple[set[str], float, float]:
    """Return what trips of 2 kg m2 without a weight, where it ends, and its largest overshoot."""
    start = float(np.radians(90.0))
    run = load('winch', {'name': 'jump', 'duration_s': 1.4 + 0.03 * abs(jump), 'tracks': {'drum': [
        {'t_s': 0.0, 'position': 'hold'}, {'t_s': 0.2, 'position': start + jump}]}}, changes={
        'actuators.drum.load.force': 0.0, 'actuators.drum.load.inertia': 2.0} | {
        f'actuators.drum.parameters.{key}': value for key, value in parameters.items()})
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', TripWarning)
        result = run.simulate()
    turned = (result['drum.position'] - start) / jump
    names = {own.name for k, own in enumerate(CONDITIONS)
             if int(result['drum.last_trip'][-1]) >> k & 1}
    return names, float(turned[-1] * jump), float((turned.max() - 1.0) * abs(jump))


@pytest.mark.parametrize('celsius', [15.0, 60.0])
@pytest.mark.parametrize('jump', [2.0, 7.0, 20.0, 98.0, -2.0, -7.0, -20.0, -98.0])
def test_jumps_pass_with_cold_and_warm_oil(jump: float, celsius: float) -> None:
    """R22 in the model's force block; 98 rad and the start are what a scenario may ask for."""
    names, end, _ = jumped(jump, **{'plant.thermal': bath(celsius)})
    assert names == set()
    assert end == pytest.approx(jump, abs=0.05)


@pytest.mark.parametrize(('jump', 'is_tripped'), [(4.0, False), (7.0, True), (-7.0, True)])
def test_a_clamped_integral_trips_where_a_long_jump_ends(jump: float, is_tripped: bool) -> None:
    """As docs/parts.md says; the trip is that of the torque's error."""
    names, end, _ = jumped(jump, **{'reu.force.anti_windup': 'clamped'})
    assert names == ({'force_error'} if is_tripped else set())
    assert (abs(end - jump) > 1.0) == is_tripped


def test_long_jumps_overshoot() -> None:
    """The impedance brakes from 70/1000 s times the speed on, which is less than it takes."""
    assert jumped(7.0)[2] == pytest.approx(1.83, abs=0.05)
    assert jumped(2.0)[2] == pytest.approx(0.098, abs=0.01)
