"""The run of a run file, or of a resolved text."""

from collections.abc import Mapping
from typing import Any

from isa_ros.config.models.catalogue import model_names
from isa_ros.config.models.links import LINK
from isa_ros.config.models.wires import refuse_overfull
from isa_ros.config.runs.acceptance import ACCEPT_ALL
from isa_ros.config.runs.actuator_config import actuator_of, Around
from isa_ros.config.runs.controller_config import CONTROLLERS
from isa_ros.config.runs.emergency_stops import (
    emergency_stops_of, KEY as EMERGENCY_STOPS, refuse_without_dump)
from isa_ros.config.runs.joined_bodies import bodies_of, moved_by
from isa_ros.config.runs.publishing import PublishConfig
from isa_ros.config.runs.run_config import RUN, RunConfig
from isa_ros.config.runs.supplies import refuse_unused_temperature, supplies_of
from isa_ros.config.runs.tick_grid import times_of
from isa_ros.config.text.names import COORDINATOR
from isa_ros.config.text.sections import Place, Section
from isa_ros.config.text.yaml_text import parse, Tree
from isa_ros.core.suggest import alternatives, listed
from isa_ros.errors import ConfigError

Origins = Mapping[str, Section]
"""The layered sections that sheets and loads were built from, by key of the resolved text."""


def run_of(tree: Tree, place: Place, is_checked: bool = True) -> tuple[RunConfig, Origins]:
    """
    Return the run of a file's tree, and what it was built from.

    ``is_checked``: whether the parts must fit together, too. Those of the text in a bag have been
    checked when it was recorded, perhaps by another version.

    Raises
    ------
    ConfigError
        The content cannot be run.

    """
    values = RUN.read(tree, place)
    step_ns, offset_ns = times_of(values, place)
    bodies, origins = bodies_of(values, place, step_ns, is_checked)
    supplies = supplies_of(values, list(values['actuators']), place)
    actuators = []
    below, moved = place / 'actuators', moved_by(bodies, values['actuators'], place)
    for name, own in values['actuators'].items():
        if name == COORDINATOR:
            raise ConfigError(f'{below / name}: the name is reserved for the coordinator')
        _refuse_without_model(name, values['actuators'], below)
        actuator, layers = actuator_of(name, own, below / name, Around(
            step_ns, values[LINK], moved.get(name), is_checked))
        actuators.append(actuator)
        origins |= {f'actuators.{name}.{key}': layer for key, layer in layers.items()}
    stops = emergency_stops_of(
        values[EMERGENCY_STOPS], list(values['actuators']), place / EMERGENCY_STOPS)
    if is_checked:
        refuse_unused_temperature(supplies, {
            name: own['parameters'] for name, own in values['actuators'].items()}, below)
        refuse_overfull({own.name: own.sheet.link for own in actuators}, place)
        refuse_without_dump(stops, supplies, place / EMERGENCY_STOPS)
    values |= {
        'step_ns': step_ns, 'controller_offset_ns': offset_ns, 'supplies': supplies,
        EMERGENCY_STOPS: stops,
        'bodies': bodies, 'actuators': tuple(actuators), 'source': values['source'] or place.file,
        'start_time_s': values['start_time_s'] or 0, 'accept': values['accept'] or ACCEPT_ALL,
        'publish': values['publish'] or PublishConfig()}
    controllers = values.pop(CONTROLLERS)
    run = RunConfig(**{name: values[name] for name in RunConfig.__dataclass_fields__
                       if name in values})
    return run.with_controllers(controllers.nodes).calling(controllers.called), origins


def _refuse_without_model(name: str, actuators: Mapping[str, Any], place: Place) -> None:
    """Refuse an actuator without model; it may be meant as another one of the run."""
    if actuators[name]['model'] is not None or actuators[name]['sheet'] is not None:
        return
    others = [key for key, own in actuators.items() if own['model'] is not None]
    meant = f'; if one of the others is meant: {alternatives(name, others)}' if others else ''
    raise ConfigError(f'{place / name} lacks model, one of {listed(model_names())}{meant}')


def run_of_tree(tree: Tree, name: str) -> RunConfig:
    """Return the run of the tree of a resolved text; as `run_of_text`."""
    return run_of(tree, Place(name), is_checked=False)[0]


def run_of_text(text: str, name: str = 'configuration.yaml') -> RunConfig:
    """
    Return the run of a resolved text; error messages begin with ``name``.

    Raises
    ------
    ConfigError
        The text is not an output of `RunConfig.to_yaml`.

    """
    return run_of_tree(parse(text, name), name)
