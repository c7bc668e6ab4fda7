"""Errors of faulty runs against the sound one, and as text."""

from isa_ros.analysis.faults.recorded import EXACT, in_mm, in_newtons, largest_error, recorded
from isa_ros.analysis.faults.rigs import common_rigs
import numpy as np
import pytest


@pytest.mark.parametrize(('error', 'text'), [
    (0.0578634, '57.9'), (6.47e-8, '0'), (2.8e-6, '0.003'), (0.1, '100')])
def test_a_distance_has_three_digits_and_no_less_than_a_micrometre(error, text):
    assert in_mm(error) == text


@pytest.mark.parametrize(('error', 'text'), [
    (999.6, '1000'), (21784.6, '21785'), (2.57, '2.6'), (10.4, '10'), (9.96, '10.0'),
    (0.0, '0.0')])
def test_a_force_has_whole_newtons_and_small_ones_a_tenth(error, text):
    assert in_newtons(error) == text


def test_an_error_is_the_largest_distance_before_a_tick_in_either_direction():
    sound = {'x': np.zeros(4)}
    faulty = {'x': np.array([1.0, -3.0, 2.0, 5.0])}
    assert largest_error(faulty, sound, 'x', 3) == 3.0
    assert largest_error(faulty, sound, 'x') == 5.0


def test_exact_signals_are_those_behind_the_sensors():
    """A bias of 1 mm and 500 N in the readings at rest, within the first ms, before loops act."""
    rig, _ = common_rigs()
    faults = ({'t_s': 0.0, 'actuator': 'ram', 'set': {
        'plant.sensors.position.bias': 1e-3, 'plant.sensors.force.bias': 500.0}},)
    signals = recorded(rig, faults, 0.001)
    position, force = (signals[name] for name in EXACT)
    assert position[1] == pytest.approx(0.05, abs=2e-5) and abs(force[1]) < 100.0
    assert signals['position'][1] - position[1] == pytest.approx(1e-3, abs=2e-6)
    assert signals['force'][1] - force[1] == pytest.approx(500.0, abs=10.0)
