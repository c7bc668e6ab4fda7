"""One actuator of a packaged model on its default load, without a run file."""

from typing import Any

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.actuator.timing import Timing
from isa_ros.config.models.catalogue import Model
from isa_ros.config.models.own_load import own_load
from isa_ros.config.runs.actuator_config import ACTUATOR, actuator_of, ActuatorConfig, Around
from isa_ros.config.runs.model_run import model_run
from isa_ros.config.text.sections import Place
from isa_ros.loads.sheets import LocalLoad

DEFAULT_TIMING = Timing(step_ns=1_000_000, controller_offset_ns=120_000)  # coupling.md


def default_actuator(model: str, name: str) -> ActuatorConfig:
    """
    Return an actuator of a model, at mid stroke on the model's default load.

    It is that of the run file of the model alone; reading the rest of one would import all that
    a run may have.

    Raises
    ------
    ConfigError
        The model does not exist.

    """
    place = Place(model) / 'actuators' / model
    actuators: Any = model_run(model)['actuators']
    own = ACTUATOR.read(actuators[model], place)
    return actuator_of(name, own, place, Around(DEFAULT_TIMING.step_ns, {}, None, True))[0]


def default_load(model: Model, sheet: ActuatorSheet) -> LocalLoad:
    """Return the default load of an actuator made from a model; as `own_load`."""
    place = Place(model.name) / 'load'
    return own_load({'kind': model.default_load}, place, model, sheet)
