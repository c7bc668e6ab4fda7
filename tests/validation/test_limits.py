"""Limits of the plant: each is noticed by the entry that is about it, and by hardly another."""

from isa_ros.validation.actuators import Change, CheckedActuators
from isa_ros.validation.behaviour import MODELS
from isa_ros.validation.limits import limits
from isa_ros.validation.sensitivity import PERTURBATIONS
import pytest


@pytest.mark.parametrize('name, noticing', [
    ('spool stop -20 %', {'full_speed'}),
    ('orifice smoothing x10', {'loaded_speed'}),
    ('end-stop stiffness /2', {'stop'}),
    ('converters of one bit less', {'force_code'}),
    ('encoder x10', {'position_code'})])
def test_a_moved_limit_is_noticed_by_its_entry(name: str, noticing: set[str]) -> None:
    change, = (each.change for each in PERTURBATIONS if each.name == name)
    missed = {entry.name for entry in limits(CheckedActuators(change)).entries
              if not entry.is_reached}
    assert missed >= {f'{model}_{entry}' for model in MODELS for entry in noticing}
    assert len(missed) <= len(MODELS) + 1


def test_as_shipped_all_are_reached_and_another_supply_moves_the_motions_alone() -> None:
    assert all(entry.is_reached for entry in limits().entries)
    weaker = limits(CheckedActuators(Change(('supply.pressure_mpa',), 0.8))).entries
    assert {entry.name for entry in weaker if entry.is_reached} == {
        f'{model}_{what}_code' for model in MODELS for what in ('force', 'position')}
