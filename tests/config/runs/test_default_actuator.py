"""The actuator of a model without a run file."""

from dataclasses import replace

from isa_ros.config.models.catalogue import model_names
from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.config.runs.model_run import model_run
from isa_ros.config.runs.run_reading import run_of
from isa_ros.config.text.sections import Place
from isa_ros.errors import ConfigError
import pytest


@pytest.mark.parametrize('model', model_names())
def test_it_is_that_of_the_run_of_its_model(model):
    run, _ = run_of(model_run(model), Place(model))
    assert replace(run.actuators[0], name='kfe') == default_actuator(model, 'kfe')
    assert (run.step_ns, run.controller_offset_ns) == (
        DEFAULT_TIMING.step_ns, DEFAULT_TIMING.controller_offset_ns)


def test_an_unknown_model_is_refused():
    with pytest.raises(ConfigError, match='isa_v9.*valid|isa_v9.*isa_v5'):
        default_actuator('isa_v9', 'kfe')
