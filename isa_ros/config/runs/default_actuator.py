"""One actuator of a packaged model on its default load, without a run file."""

from dataclasses import replace

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.actuator.timing import Timing
from isa_ros.config.models.catalogue import Model
from isa_ros.config.models.own_load import own_load
from isa_ros.config.runs.actuator_config import ActuatorConfig
from isa_ros.config.runs.model_run import model_run
from isa_ros.config.runs.run_reading import run_of
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
    run, _ = run_of(model_run(model), Place(model))
    return replace(run.actuators[0], name=name)


def default_load(model: Model, sheet: ActuatorSheet) -> LocalLoad:
    """Return the default load of an actuator made from a model; as `own_load`."""
    place = Place(model.name) / 'load'
    return own_load({'kind': model.default_load}, place, model, sheet)
