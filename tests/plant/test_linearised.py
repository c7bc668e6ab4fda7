"""The linearised plant: its chambers against the flows of the valve itself."""

import math

from isa_ros.core.timebase import FASTEST_RATE
from isa_ros.plant.linearised import fastest_rate, is_followed, LoadSide, matrices
from isa_ros.plant.plant import plant_record
from isa_ros.plant.servo_valve import conductances
import numpy as np
import pytest
from tests.sheets import actuator_sheet, MODELS

LOAD = LoadSide(inertia=20.0)
CHAMBERS = 3, 4
"""Rows of P_A and P_B."""


def small_valve(model):
    """Return the `PLANT` of a model with a valve so small that no flow is too fast for a step."""
    plant = plant_record(actuator_sheet(model).plant)[0].copy()
    plant['valve']['per_root_drop'] *= 1e-4
    return plant


def stiffness(plant, place):
    """Return beta/V of both chambers, Pa/m3."""
    oil = plant['chambers']
    return (oil['beta'] / (oil['dead_volume'] + oil['swept_a'] * place),
            oil['beta'] / (oil['dead_volume'] + oil['swept_b'] * (oil['stroke'] - place)))


@pytest.mark.parametrize('model', MODELS)
def test_chambers_lose_pressure_by_the_valve_s_own_lands(model):
    """Shut by twice the larger land; wide open by no more than that in addition."""
    plant = small_valve(model)
    valve, oil = plant['valve'], plant['chambers']
    own = list(matrices(plant, LOAD))[2:]
    per_root = 1.0 / math.sqrt(valve['delta'])
    for place, (shut, wide) in zip((0.0, oil['stroke']), (own[:2], own[2:])):
        for row, per, side in zip(CHAMBERS, stiffness(plant, place), ((0, 1), (2, 3))):
            lands, _ = conductances(0.0, valve)
            closed = 2.0 * max(lands[k] for k in side) * per_root
            assert -shut[row, row] / per == pytest.approx(oil['c_li'] + closed, rel=1e-9, abs=0.0)
            lands = np.maximum(*(conductances(x, valve)[0] for x in (
                valve['x_max'], -valve['x_max'])))
            opened = max(lands[k] for k in side) * per_root
            found = -wide[row, row] / per - oil['c_li']
            assert opened < found <= opened + closed
    assert is_followed(plant, LOAD)


def test_a_large_valve_is_as_fast_as_a_step_follows():
    plant = plant_record(actuator_sheet('isa_v5').plant)[0].copy()
    plant['valve']['per_root_drop'] *= 30.0
    _, _, shut, wide, *_ = matrices(plant, LOAD)
    oil = plant['chambers']
    for row, per in zip(CHAMBERS, stiffness(plant, 0.0)):
        assert wide[row, row] == pytest.approx(
            -FASTEST_RATE - per * oil['c_li'], rel=1e-12, abs=0.0)
        assert wide[row, row] < shut[row, row]
    assert fastest_rate(plant, LOAD) >= FASTEST_RATE


def test_trapped_oil_is_that_of_shut_lands():
    sheet = actuator_sheet('cylinder', 'default', 'cushioned')
    plant = plant_record(sheet.plant)[0].copy()
    plant['valve']['per_root_drop'] *= 1e-4
    found = list(matrices(plant, LOAD))
    dead = plant['chambers']['dead_volume']
    shut, _, trapped, released = found[2:6]
    cushion = plant['cushion_a']
    assert cushion['is_on'] and trapped.shape == (8, 8)
    wide = dead / (dead - cushion['dead'])
    assert trapped[3, 3] == pytest.approx(wide * shut[3, 3], rel=1e-12, abs=0.0)
    assert trapped[7, 7] == 0.0 > released[7, 7]
    assert released[3, 3] < trapped[3, 3]
