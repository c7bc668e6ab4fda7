"""What a scenario changes of the rig: the starts of bodies, and loads of single actuators."""

from dataclasses import replace
from typing import Any

from isa_ros.config.models.catalogue import actuator_model
from isa_ros.config.models.own_load import own_load, refuse_beyond_stops
from isa_ros.config.runs.body_config import BodyConfig
from isa_ros.config.runs.run_config import ActuatorConfig, RunConfig
from isa_ros.config.text.sections import Place, section_at
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError


def refuse_stranger(name: str, run: RunConfig, place: Place) -> None:
    """Refuse a name at a place that is no actuator of a run; raises `ConfigError`."""
    try:
        run.actuator(name)
    except ConfigError as error:
        raise ConfigError(f'{place} is unknown: {error}') from error


def with_starts(run: RunConfig, tree: Tree, place: Place) -> RunConfig:
    """Return the run with the starts of bodies: of ``leg``, the only one, or by name."""
    starts: list[tuple[BodyConfig, Place, Any]] = []
    if 'leg' in tree:
        if run.leg is None:
            raise ConfigError(f'{place / "leg"} is not used: {run.source} has no leg')
        starts.append((run.leg, place / 'leg', tree['leg']))
    for name, section in section_at(tree.get('bodies', {}), place / 'bodies').items():
        below, body = place / 'bodies' / name, run.body(name)
        if body is None:
            names = [own.name for own in run.bodies]
            raise ConfigError(f'{below} is not a body; {alternatives(name, names)}')
        starts.append((body, below, section))
    for body, below, section in starts:
        body = body.started(section_at(section, below), below, run.step_ns)
        run = run.with_body(body)
        for joint, actuator in body.joints:
            body.refuse_reach(joint, run.actuator(actuator).sheet, str(below))
    return run


def with_loads(run: RunConfig, tree: Tree, place: Place) -> RunConfig:
    """Return the run with the loads of single actuators."""
    loads = section_at(tree.get('loads', {}), place / 'loads')
    replaced: dict[str, ActuatorConfig] = {}
    for name, section in loads.items():
        below = place / 'loads' / name
        refuse_stranger(name, run, below)
        actuator = run.actuator(name)
        body = run.body_of(name)
        if body is not None:
            raise ConfigError(f'{below} is not used: the load of {name} is {body.called}')
        model = actuator_model(actuator.model, f'{run.source}: actuators.{name}.model')
        load = own_load(section_at(section, below), below, model, actuator.sheet)
        refuse_beyond_stops(
            load, actuator.initial_position, actuator.sheet.is_rotary, str(below))
        replaced[name] = replace(actuator, load=load)
    return replace(run, actuators=tuple(replaced.get(a.name, a) for a in run.actuators))
