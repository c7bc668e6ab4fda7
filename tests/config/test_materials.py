"""Named materials: whole data with sources, selectable under the foot and before a load."""

from pathlib import Path

import isa_ros
from isa_ros.config.listing import rows
from isa_ros.config.models.catalogue import material_section
from isa_ros.config.text.parameter_sets import build
from isa_ros.errors import ConfigError
from isa_ros.surroundings.ground import Ground
import pytest
from tests.sheets import MODELS, own_load

MATERIALS = sorted(
    path.stem for path in (Path(isa_ros.__file__).parent / 'config/data/materials').glob('*.yaml'))


def material(name):
    """Return a material as a ground."""
    return build(Ground, *material_section(name, 'test'))


def test_there_are_metal_rubber_and_wood():
    """The materials of the paper's rigs."""
    assert MATERIALS == ['metal', 'rubber', 'wood']


@pytest.mark.parametrize('name', MATERIALS)
def test_every_value_of_a_material_says_why(name):
    """Assumed with a reason, in units of the ground."""
    section, place = material_section(name, 'test')
    table = rows(build(Ground, section, place), section)
    assert all(row.source.startswith('assumed') for row in table)
    assert all(len(row.source) > len('assumed, ') for row in table[:4])


def test_rubber_is_softer_and_more_damping_than_wood_and_wood_than_metal():
    """Stiffness ascends, losses descend, from rubber over wood to metal."""
    rubber, wood, metal = (material(name) for name in ('rubber', 'wood', 'metal'))
    assert rubber.stiffness < wood.stiffness < metal.stiffness
    assert rubber.damping > wood.damping > metal.damping


@pytest.mark.parametrize('model', MODELS)
@pytest.mark.parametrize('name', MATERIALS)
def test_pad_of_a_model_has_the_numbers_of_its_material(model, name):
    """One set of numbers for ground and pads."""
    pad, ground = own_load(model, name), material(name)
    assert (pad.stiffness, pad.damping) == (ground.stiffness, ground.damping)


def test_an_unknown_material_is_answered_with_the_right_ones():
    """One line with the key and the closest names."""
    with pytest.raises(ConfigError, match="ground = 'wod' is not a material; did you mean wood"):
        material_section('wod', 'run.yaml: leg.ground')
