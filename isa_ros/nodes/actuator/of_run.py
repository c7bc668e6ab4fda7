"""The actuator of a node that a run file declares."""

from dataclasses import replace

from isa_ros.config.assembly import timing_of
from isa_ros.config.models.catalogue import actuator_model
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.runs.acceptance import ACCEPT_ALL
from isa_ros.config.runs.default_actuator import default_load
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.text.changes import changes_of
from isa_ros.config.text.names import placed
from isa_ros.errors import ConfigError
from isa_ros.nodes.actuator.node import NodeSetup
from isa_ros.scenario.scenario import planned
from rclpy.node import Node


def setup_of(node: Node, path: str, scenario: str, model: str) -> NodeSetup:
    """
    Return the actuator that a run file declares by the name of a node.

    ``scenario`` may change loads or start of the run, '': there is none; ``model`` is what the
    actuator has to be of, '': any.

    Raises
    ------
    ConfigError
        The run cannot be read, or has no such actuator, or one of another model.

    """
    changes = changes_of(node.get_parameter_or('set').value or ())
    run = load_run(find(path, CONFIG), changes.run)
    run = planned(find(scenario, SCENARIOS) if scenario else None, run, changes).run
    return _from_run(run, _name_in(run, node), model, bool(node.get_parameter('lockstep').value))


def _name_in(run: RunConfig, node: Node) -> str:
    """Return the name of a node in a run, with its namespace if that is a robot's."""
    name: str = node.get_name()
    robot = placed(node.get_namespace().rpartition('/')[2], name)
    return robot if any(own.name == robot for own in run.actuators) else name


def _from_run(run: RunConfig, name: str, model: str, in_lockstep: bool) -> NodeSetup:
    config = run.actuator(name)
    if model not in ('', config.model):
        raise ConfigError(
            f'{run.source}: {name} has model {config.model}, the parameter model = {model!r}')
    if config.load is None and not in_lockstep:
        model_of = actuator_model(config.model, name)
        config = replace(config, load=default_load(model_of, config.sheet))
    # Alone it has no scenario that could command it.
    return NodeSetup(
        config, timing_of(run), accept=run.accept if in_lockstep else ACCEPT_ALL,
        period_of=run.publish.period)
