"""Cavities of the plant: each law below the atmosphere is noticed by the entry about it."""

from isa_ros.validation.actuators import Change, CheckedActuators, SHIPPED
from isa_ros.validation.behaviour import MODELS, SHUT
from isa_ros.validation.cavities import cavities, moved, SEALED
from isa_ros.validation.sensitivity import PERTURBATIONS
import pytest


@pytest.mark.parametrize('name, noticing', [
    ('refill /10', {'refill'}),
    ('aeration x10', {'released_air', 'oil_beside_a_cavity'}),
    ('vapour pressure 0', {'cavity_pressure', 'refill'}),
    ('sensor damping x3', set())])
def test_a_wrong_law_is_noticed_by_its_entry(name: str, noticing: set[str]) -> None:
    change, = (each.change for each in PERTURBATIONS if each.name == name)
    missed = {entry.name for entry in cavities(CheckedActuators(change)).entries
              if not entry.is_reached}
    assert missed == {f'{model}_{entry}' for model in MODELS for entry in noticing}


def test_as_shipped_all_are_reached_and_the_bars_stay() -> None:
    shipped = cavities().entries
    assert all(entry.is_reached for entry in shipped)
    stiffer = cavities(CheckedActuators(
        Change(('plant.oil.effective_bulk_modulus',), 1.3))).entries
    assert [each.tolerance for each in stiffer] == [each.tolerance for each in shipped]


@pytest.mark.parametrize('model', MODELS)
def test_a_chamber_is_torn_open_and_closed_again(model: str) -> None:
    """Widest outside, gone after the way back; the refill leaves less of it."""
    sealed = moved(SHIPPED, model, SEALED, 0.01, 0.01)
    assert sealed.cavity[0] == sealed.cavity[-1] == 0.0
    assert abs(int(sealed.cavity.argmax()) - len(sealed.cavity) // 2) < 5
    assert sealed.cavity.max() > 0.8 * (sealed.volume.max() - sealed.volume[0])
    refilled = moved(SHIPPED, model, SHUT, 0.01, 0.01)
    assert 0.0 < refilled.cavity.max() < 0.9 * sealed.cavity.max()
