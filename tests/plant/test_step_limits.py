"""The least temperature of its oil that an actuator's step can follow."""

import math

from isa_ros.plant.linearised import is_followed, LoadSide
from isa_ros.plant.plant import plant_record
from isa_ros.plant.step_limits import coldest_followed
from isa_ros.plant.thermal import warm
from isa_ros.scripting.run import load
import numpy as np
import pytest

LIGHT, HEAVY = LoadSide(inertia=0.05), LoadSide(inertia=50.0)


def cylinder() -> np.record:
    """Return the `PLANT` of an ISA v5 with a temperature of its own, from 15 celsius on."""
    sheet = load('warm_stand').configuration.actuator('moved').sheet
    own: np.record = plant_record(sheet.plant)[0]
    return own


def follows(celsius: float, side: LoadSide) -> bool:
    """Return whether the step follows it with oil of a temperature."""
    warmed = cylinder().copy()
    warm(celsius, warmed)
    return bool(is_followed(warmed, side))


@pytest.mark.parametrize('side', [LIGHT, HEAVY])
def test_the_step_follows_it_and_not_what_is_colder(side: LoadSide) -> None:
    """Within 0.01 K."""
    found = coldest_followed(cylinder(), side, -60.0)
    assert -30.0 < found < -25.0
    assert follows(found, side) and not follows(found - 0.01, side)


def test_a_light_load_is_too_fast_with_warmer_oil() -> None:
    plant = cylinder()
    assert coldest_followed(plant, LIGHT, -60.0) > coldest_followed(plant, HEAVY, -60.0) + 1.0


def test_without_a_bound_it_follows_all() -> None:
    """From -20 celsius on."""
    assert coldest_followed(cylinder(), HEAVY, -20.0) == -math.inf


def test_the_plant_keeps_its_values() -> None:
    """Those at 40 celsius, at which its sheet has them."""
    plant = cylinder()
    before = plant.tobytes()
    assert coldest_followed(plant, HEAVY, -60.0) > -60.0
    assert plant.tobytes() == before
