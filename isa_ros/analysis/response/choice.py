"""
What a command measures: an actuator of a model or of a run file, with other values.

A model is measured in the run of `isa_ros.config.runs.model_run`. Keys of other values are those
of the run file, or of the measured actuator.
"""

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Any, NamedTuple

from isa_ros.config.models.catalogue import model_names
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.model_run import full_keys, LOAD, model_run
from isa_ros.config.runs.robots import run_with_robots
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.text.changes import changed
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import read, Tree
from isa_ros.core.frozen import frozen
from isa_ros.errors import ConfigError


@frozen(kw_only=True)
class Choice:
    """The rig that a user names; None takes the default."""

    name: str
    """A packaged model, or a run file."""
    loop: str
    actuator: str | None = None
    preset: str | None = None
    variants: Sequence[str] = ()
    load: str | None = None
    position: float | None = None
    """mm or deg."""
    values: Mapping[str, Any] = field(default_factory=dict)
    """Other values by key, in the units of the files."""

    @property
    def keeps_load(self) -> bool:
        """Return whether the actuator is measured on the load it has."""
        return self.load is None and self.loop == 'position'


class ChosenRun(NamedTuple):
    """A run with the chosen values, and which of its actuators is measured."""

    tree: Tree
    """Of a complete run file."""
    place: Place
    run: RunConfig
    actuator: str
    load_values: Mapping[str, Any]
    """Other values of the load that the actuator is measured on, without their prefix."""


def chosen(choice: Choice) -> ChosenRun:
    """
    Return the run that a user names.

    Raises
    ------
    ConfigError
        Something of the choice does not exist or does not fit.

    """
    if choice.name in model_names():
        tree, place, name = _of_model(choice), Place(choice.name), choice.name
        keeps_load = choice.keeps_load
    else:
        tree, place = _of_file(choice)
        before = run_with_robots(tree, place)[0]
        name = _actuator(before, choice)
        keeps_load = choice.keeps_load and before.body_of(name) is None
    values, load_values = {}, {}
    for key, value in choice.values.items():
        head, _, rest = key.partition('.')
        if head == LOAD and rest and not keeps_load:
            load_values[rest] = value
        else:
            values[key] = value
    tree = changed(tree, full_keys(values, name), place.file)
    return ChosenRun(tree, place, run_with_robots(tree, place)[0], name, load_values)


def _of_model(choice: Choice) -> Tree:
    if choice.actuator is not None:
        raise ConfigError(
            f'--actuator {choice.actuator} is not used: {choice.name} is a model, not a run file')
    return model_run(choice.name, choice.preset, choice.variants)


def _of_file(choice: Choice) -> tuple[Tree, Place]:
    for option, value in (('--preset', choice.preset), ('--variant', choice.variants)):
        if value:
            raise ConfigError(
                f'{option} is not used: {choice.name} is no model, a run file says it itself; '
                f'models: {", ".join(model_names())}')
    others = {} if choice.name.endswith('.yaml') else {'models': model_names()}
    path = find(choice.name, CONFIG, others)
    return read(path), Place.of(path)


def _actuator(run: RunConfig, choice: Choice) -> str:
    if choice.actuator is not None:
        return run.actuator(choice.actuator).name
    if len(run.actuators) > 1:
        names = ', '.join(actuator.name for actuator in run.actuators)
        raise ConfigError(f'{run.source} has several actuators, --actuator must name one: {names}')
    return run.actuators[0].name
