"""Gain schedule over the stroke."""

from hypothesis import given, strategies as st
from isa_ros.actuator.sheet import force_stiffness
from isa_ros.plant.chambers import oil_stiffness
from isa_ros.reu.schedule import (
    Constant, FivePoints, OilStiffness, POINTS, schedule_table, scheduled, ThreePoints)
import numpy as np
import pytest
from tests.sheets import plant_row

TABLE = np.linspace(1.0, 3.0, POINTS)


@given(fraction=st.floats(-0.5, 1.5))
def test_a_straight_table_is_reproduced_and_clamped(fraction):
    """R6: straight lines between the points, the end values outside."""
    expected = 1.0 + 2.0 * min(1.0, max(0.0, fraction))
    assert scheduled(fraction * 0.1, 0.1, TABLE) == pytest.approx(expected, rel=1e-12)
    assert scheduled(fraction * 0.1, 0.1, TABLE) == \
        scheduled.py_func(fraction * 0.1, 0.1, TABLE)


def test_oil_stiffness_schedule_keeps_the_loop_gain():
    """R6, C4: gain times oil stiffness in series with the sensor is the same everywhere."""
    plant = plant_row('isa_v5')
    table = schedule_table(OilStiffness(), force_stiffness(plant))
    positions = np.linspace(0.0, plant.chambers.stroke, POINTS)
    oil = np.array([oil_stiffness(s, plant.chambers) for s in positions])
    loop = table / (1.0 / oil + 1.0 / plant.mechanics.k_s)
    assert loop == pytest.approx(np.full(POINTS, loop[0]), rel=1e-12)
    assert table.max() == 1.0


def test_constant_schedule_is_one():
    """The paper's ISA v5 needs no scheduling by direction (section 2.3)."""
    assert (schedule_table(Constant(), force_stiffness(plant_row('isa_v5'))) == 1.0).all()


def test_three_points_are_joined_by_straight_lines():
    """R6: a table given by the user."""
    table = schedule_table(ThreePoints(retracted=0.5, middle=1.0, extended=2.0), np.ones(POINTS))
    assert [table[0], table[5], table[10], table[15], table[20]] == [0.5, 0.75, 1.0, 1.5, 2.0]


def test_five_points_are_joined_by_straight_lines():
    """R6: a table of quarters; between two of them half of each."""
    factors = {'retracted': 0.25, 'first_quarter': 0.75, 'middle': 1.0, 'last_quarter': 0.5,
               'extended': 2.0}
    table = schedule_table(FivePoints(**factors), np.ones(POINTS))
    assert list(table[::5]) == list(factors.values())
    # the nodes are five intervals apart: 0.25 + 2/5 of 0.5
    assert table[2] == pytest.approx(0.45, rel=1e-12, abs=0.0)
