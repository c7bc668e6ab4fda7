"""Behaviour of the plant: the solutions it is compared with, and that a change is noticed."""

import math

from isa_ros.actuator.actuator import PAPER_SUPPLY
from isa_ros.validation import behaviour, plant_theory
from isa_ros.validation.actuators import Change, CheckedActuators, SHIPPED
from isa_ros.validation.valve_flow import no_load_speed
import pytest


def test_the_free_frequency_is_that_of_springs_in_series_for_a_light_piston():
    """
    Oil 7e8 (8.59e-6)^2 (1/2.499e-6 + 1/14.49e-6), sensor 2e4 in series, 0.6 kg m2.

    The rotor, 1/200 of the load, adds less than (k_s/k)^2 of that to the effective mass: 0.2 %.
    """
    swept = 8.59e-6 * 1.745
    oil = 7e8 * 8.59e-6 ** 2 * (1 / (1e-6 + 0.1 * swept) + 1 / (1e-6 + 0.9 * swept))
    series = 1 / (1 / oil + 1 / 2e4)
    assert plant_theory.free_frequency('smart_manifold', 0.1, 0.6) == pytest.approx(
        math.sqrt(series / 0.6) / (2 * math.pi), rel=2e-3)


@pytest.mark.parametrize('model', behaviour.MODELS)
def test_a_steady_motion_balances_forces_and_needs_its_spool(model):
    """The spool solved for a speed gives that speed; without friction it is a little more."""
    spool = behaviour.spool_at(model, 1.5)
    found = plant_theory.steady(model, spool=spool)
    assert plant_theory.steady(model, speed=found.speed).spool == pytest.approx(spool, rel=1e-6)
    ideal = no_load_speed(1.5, model)
    assert 0.95 * ideal < found.speed < ideal


def test_a_closed_valve_of_equal_slots_holds_nothing():
    assert plant_theory.holding_force('smart_manifold', 0.0) == pytest.approx(0.0, abs=1e-6)
    most = 8.59e-6 * PAPER_SUPPLY
    assert 0.0 < plant_theory.holding_force('smart_manifold', 1e-6) < most


def test_a_changed_parameter_moves_ours_and_not_the_bar():
    """Friction x3 under the same load stops it, but for the end of its transient."""
    change = CheckedActuators(Change(('plant.friction.stiction', 'plant.friction.coulomb'), 3.0))
    shipped, changed = (
        {entry.name: entry for entry in behaviour.behaviour(each).entries}
        for each in (SHIPPED, change))
    slip = 'smart_manifold_slip'
    assert all(entry.is_reached for entry in shipped.values())
    assert shipped[slip].tolerance == changed[slip].tolerance
    assert not changed[slip].is_reached
    assert abs(changed[slip].ours) < 0.2 * shipped[slip].ours
