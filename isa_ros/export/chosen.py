"""Which actuator is exported: one of a model alone, or of a run file."""

from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

from isa_ros.config.listing import ListedValue, rows, SET
from isa_ros.config.models.catalogue import model_names
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.actuator_config import ActuatorConfig
from isa_ros.config.runs.model_run import assumed_keys, full_keys, model_run
from isa_ros.config.runs.robots import run_with_robots
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_reading import Origins
from isa_ros.config.text.changes import changed, Values
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import read, Tree
from isa_ros.core.parameter import Parameters
from isa_ros.core.suggest import alternatives, listed
from isa_ros.errors import ConfigError

OWN, PORT = 'own', 'port'
LOADS = (OWN, PORT)
"""Where the load of an exported actuator is: its own, or the caller's at its port."""
ASSUMED = 'assumed, not given'
"""Source of a parameter of the user's data sheets that the model's value stands for."""


class ChosenActuator(NamedTuple):
    """An actuator of a run."""

    run: RunConfig
    origins: Origins
    row: int
    values: Values
    """Those that replace others, by their keys in the run file."""
    assumed: Sequence[str] = ()
    """Keys of its parameters that data sheets would have, of a model of which none is given."""

    @property
    def config(self) -> ActuatorConfig:
        """Return its configuration."""
        return self.run.actuators[self.row]

    def parameters(self) -> list[tuple[ListedValue, float | str]]:
        """Return its parameters as `isa params` lists them, with their values."""
        place = f'actuators.{self.config.name}'
        found = self._listed(self.config.sheet, f'{place}.sheet', '', f'{place}.parameters.')
        if self.config.load is not None:
            found += self._listed(self.config.load, f'{place}.load', 'load.', f'{place}.')
        return found

    @property
    def assumptions(self) -> list[str]:
        """Return the assumed parameters with their values."""
        values = {row.parameter: row.value for row, _ in self.parameters()}
        return [f'{key} = {values[key]}' for key in self.assumed]

    def _listed(self, sheet: Parameters, origin: str, prefix: str, place: str) -> list[
            tuple[ListedValue, float | str]]:
        """Return the rows of a set; ``prefix`` begins names, ``place`` their keys in the run."""
        found = []
        for row in rows(sheet, self.origins.get(origin, {})):
            value = value_of(sheet, row)
            name = f'{prefix}{row.parameter}'
            is_set = any(f'{place}{name}.'.startswith(f'{key}.') for key in self.values)
            source = SET if is_set else ASSUMED if name in self.assumed else row.source
            found.append((row._replace(parameter=name, source=source), value))
        return found


def value_of(sheet: Parameters, row: ListedValue) -> float | str:
    """Return the value of a row: a number exactly, anything else as it is shown."""
    value: object = sheet
    for name in row.parameter.split('.'):
        value = getattr(value, name, None)
    return float(value) if isinstance(value, (int, float)) else row.value


def choose(
        text: str, values: Values = MappingProxyType({}), *, preset: str | None = None,
        variants: Sequence[str] = (), load: str | None = None) -> ChosenActuator:
    """
    Return the actuator of a text MODEL, or of FILE or FILE:ACTUATOR of a run file.

    ``values`` replace others by their keys; those of the actuator may be as `isa params` of its
    model shows them. ``load`` is one of `LOADS`; None: a model has its load at the port, an
    actuator of a run file its own, if it has one. ``preset`` and ``variants`` are of a model.

    Raises
    ------
    ConfigError
        There is no such model, file or actuator, the file cannot be run, a preset is given for a
        run file, or the actuator has no load of its own.

    """
    head, colon, name = text.rpartition(':')
    file = head if colon else name
    if file in model_names():
        if colon:
            raise ConfigError(f'{text}: {file} is a model, must be a run file before a colon')
        tree, place = model_run(file, preset, variants), Place(file)
        load = load or PORT
    else:
        tree, place = _read(file, preset, variants)
    names = [actuator.name for actuator in run_with_robots(tree, place)[0].actuators]
    if not colon and len(names) > 1:
        raise ConfigError(f'{file} has {len(names)} actuators, must be {file}:ACTUATOR with one '
                          f'of {listed(names)}')
    name = name if colon else names[0]
    if name not in names:
        raise ConfigError(f'{name!r} is not an actuator of {file}; {alternatives(name, names)}')
    values = full_keys(values, name)
    run, origins = run_with_robots(changed(tree, values, place.file), place)
    return ChosenActuator(
        _with_load(run, name, load, file), origins, run.index(name), values,
        assumed_keys(file, values) if file in model_names() else ())


def _read(file: str, preset: str | None, variants: Sequence[str]) -> tuple[Tree, Place]:
    """Return the tree of a run file and its place."""
    for option, given in (('--preset', preset), ('--variant', variants)):
        if given:
            raise ConfigError(
                f'{option} is not used: {file} is not a model, and a run file has its own; '
                f'models: {", ".join(model_names())}')
    path = find(file, CONFIG, {'models': model_names()})
    return read(path), Place.of(path)


def _with_load(run: RunConfig, name: str, load: str | None, file: str) -> RunConfig:
    """Return the run in which an actuator has its load where it is wanted."""
    own = run.actuator(name)
    if load == OWN and own.load is None:
        raise ConfigError(
            f'--load {OWN}: {name} of {file} moves a body, must have a load of its own')
    if load != PORT or own.load is None:
        return run
    return replace(run, actuators=tuple(
        replace(own, load=None) if actuator is own else actuator for actuator in run.actuators))
