"""One actuator of a packaged model on its default load, without a run file."""

from isa_ros.actuator.actuator import PAPER_SUPPLY, Timing
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.models.catalogue import actuator_model, DEFAULT_PRESET, Model
from isa_ros.config.models.own_load import own_load
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.sections import Place
from isa_ros.loads.sheets import LocalLoad

DEFAULT_TIMING = Timing(step_ns=1_000_000, controller_offset_ns=120_000)  # coupling.md


def default_actuator(model: str, name: str) -> ActuatorConfig:
    """
    Return an actuator of a model, at mid stroke on the model's default load.

    Raises
    ------
    ConfigError
        The model does not exist.

    """
    found = actuator_model(model, 'model')
    sheet = build(ActuatorSheet, found.with_preset(DEFAULT_PRESET, 'preset'), found.place)
    return ActuatorConfig(
        name, found.name, DEFAULT_PRESET, sheet, default_load(found, sheet),
        0.5 * sheet.plant.drive.stroke)


def default_load(
        model: Model, sheet: ActuatorSheet, supply: float = PAPER_SUPPLY) -> LocalLoad:
    """Return the default load of an actuator made from a model; as `own_load`."""
    place = Place(model.name) / 'load'
    return own_load({'kind': model.default_load}, place, model, sheet, supply)
