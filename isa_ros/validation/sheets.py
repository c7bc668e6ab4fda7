"""The shipped actuators for the checks, read once; callers must not change them."""

from functools import cache

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.models.catalogue import actuator_model
from isa_ros.config.text.parameter_sets import build
from isa_ros.plant.plant import plant_record
import numpy as np

PRESET = 'table_4'    # the paper's gains; the paper has none for the ISA v2
FALLBACK = 'default'


@cache
def model_sheet(model: str, *variants: str) -> ActuatorSheet:
    """
    Return the data sheet of a shipped model with the paper's gains, and its variants.

    Raises
    ------
    ConfigError
        The model or variant does not exist.

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
