"""The shipped actuators as the checks need them, read once; nobody changes what is returned."""

from functools import cache

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.catalogue import actuator_model
from isa_ros.config.sections import build
from isa_ros.plant.plant import plant_record
import numpy as np

PRESET = 'table_4'    # the paper's gains; it prints none for the ISA v2
FALLBACK = 'default'


@cache
def model_sheet(model: str, *variants: str) -> ActuatorSheet:
    """
    Return the data sheet of a shipped model with the paper's gains, and its variants.

    Raises
    ------
    ConfigError
        There is no such model or variant.

    """
    found = actuator_model(model, 'model')
    preset = PRESET if PRESET in found.presets else FALLBACK
    section = found.with_variants(found.with_preset(preset, 'preset'), variants, 'variants')
    return build(ActuatorSheet, section, found.place)


@cache
def plant_of(model: str) -> np.record:
    """Return the `PLANT` record of a shipped model; as `model_sheet`."""
    record: np.record = plant_record(model_sheet(model).plant)[0]
    return record
