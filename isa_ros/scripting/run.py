"""A run in Python: read from files, changed by key, simulated in memory."""

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from pathlib import Path
import re
import sys
from typing import Any

from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.runs.body_config import BodyFactory
from isa_ros.config.runs.external_config import imported_factory
from isa_ros.config.runs.one_robot import of_its_robot
from isa_ros.config.runs.robots import run_with_robots
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.text.changes import replaced, SCENARIO
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import read, Tree
from isa_ros.controller import Controller
from isa_ros.core.caller import warn
from isa_ros.core.frozen import frozen
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError
from isa_ros.scenario.scenario import idle, read_scenario, Scenario
from isa_ros.scripting.result import Result, simulated
from isa_ros.simulation import Simulation
from isa_ros.text.progress import counted
from isa_ros.tick.trips import counts_of, Tripped, TripWarning

_WORDS = re.compile(r'(?<=[a-z0-9])(?=[A-Z])')

Controllers = Sequence[Controller] | Mapping[str, Controller]
Factories = BodyFactory | str | Mapping[str, BodyFactory | str]
"""What makes external bodies: a function, or its module:factory; a mapping by bodies' names."""


@frozen
class _InputFile:
    """The content of a file, and its name for messages."""

    tree: Tree
    name: str
    folder: Path = Path()

    def replaced(self, key: str, value: Any) -> '_InputFile':
        return replace(self, tree=replaced(self.tree, key, value, self.name))

    @property
    def place(self) -> Place:
        return Place(self.name, folder=self.folder)


class Run:
    """
    A configuration with its scenario, immutable; `load` creates one from files.

    Raises as `load`.
    """

    def __init__(
            self, config: _InputFile, scenario: _InputFile | None, duration: float | None,
            compression: str | None, split_mb: float | None) -> None:
        self._config, self._scenario_file = config, scenario
        self._options: dict[str, Any] = {
            'duration': duration, 'compression': compression, 'split_mb': split_mb}
        run = run_with_robots(config.tree, config.place)[0].stored(
            compression, split_mb, 'record options')
        plan = idle(run) if scenario is None else read_scenario(
            scenario.tree, scenario.place, run)
        self.scenario: Scenario = plan if duration is None else plan.lasting(duration)
        """Commands over time, with the resolved configuration as its ``run``."""

    @property
    def configuration(self) -> RunConfig:
        """Return the resolved configuration."""
        return self.scenario.run

    @property
    def actuators(self) -> tuple[str, ...]:
        """Return the names of the actuators, in the order of the file."""
        return tuple(actuator.name for actuator in self.configuration.actuators)

    def __repr__(self) -> str:
        scenario = 'no scenario' if self._scenario_file is None else self._scenario_file.name
        return f'<Run {self._config.name}, {scenario}: {", ".join(self.actuators)}>'

    def replace(self, changes: Mapping[str, Any]) -> 'Run':
        """
        Return the run with other values, by the dotted keys and in the units of its files.

        ``{'actuators.kfe.parameters.plant.friction.stiction': 150.0}``; keys of the scenario's
        file begin with ``scenario.``: ``{'scenario.tracks.kfe[1].position': 0.06}``. A key may
        name a whole section. All values are checked like those of files.

        Raises
        ------
        ConfigError
            A key is unknown or malformed, or a value is refused.

        """
        return Run(*_changed(self._config, self._scenario_file, changes), **self._options)

    def following(self, scenario: Scenario) -> 'Run':
        """Return the run with a scenario made in Python; `replace` returns to that of its file."""
        found = copy(self)
        found.scenario = scenario
        return found

    def simulation(
            self, controllers: Controllers = (), *, body: Factories | None = None) -> Simulation:
        """
        Return the run as an object to advance step by step; see `Simulation`.

        ``controllers`` take part in every step, in their order, and those with a class in the
        run, unless one of the same name is given. A mapping gives them the names
        of nodes; otherwise a controller is named after its class: sway for `Sway`.

        ``body`` makes the body of a run with ``body: {kind: external, actuators: [...]}``: it is
        called with an `isa_ros.Mounting` and returns an `isa_ros.Mechanism`, or an `isa_ros.Body`,
        at t = 0; or its ``module:factory``. A mapping has one for each external body.

        Raises
        ------
        ConfigError
            An external body is not given, or one is given that the run does not have.

        """
        named = self._named(controllers)
        return Simulation(
            self._with_names(list(named)), self._placed(named), self._factories(body))

    def simulate(
            self, duration: float | None = None, controllers: Controllers = (), *,
            faults: Sequence[Tree] = (), seed: int | None = None, progress: bool = False,
            body: Factories | None = None) -> Result:
        """
        Simulate from t = 0 and return every sample, in memory.

        ``duration`` in s; None: that of the scenario. ``controllers`` and ``body`` as in
        `simulation`.
        ``faults`` are added to those of the scenario, each as its file would have it:
        ``{'t_s': 0.5, 'actuator': 'kfe', 'fault': 'valve_stuck', 'until_s': 0.8}``.
        ``seed`` of all noise; None: that of the run. ``progress`` is shown on a terminal only.
        A condition that tripped is a `TripWarning`, one for each actuator and condition, and
        `Result.trips` has them all.

        Raises
        ------
        ConfigError
            Neither ``duration`` nor the scenario gives a duration, or a fault is refused.
        SimulationDiverged
            A state is no longer finite.

        """
        own = self if seed is None else self.replace({'seed': seed})
        named = own._named(controllers)
        plan = own._with_names(list(named))
        if duration is not None:
            plan = plan.lasting(duration)
        n_ticks = plan.n_ticks
        if n_ticks is None:
            raise ConfigError(
                f'{self._config.name}: simulate needs a duration: there is none from a scenario')
        if faults:
            plan = plan.with_faults(faults)
        report = counted(sys.stderr, 'ticks', of=self._config.name) if progress else None
        result = simulated(
            Simulation(plan, own._placed(named), self._factories(body)), n_ticks, report)
        happened = Tripped()
        happened.add(result.trips)
        for line in (*happened.lines(), *counts_of(self.actuators, result.log.samples[-1])):
            warn(line, TripWarning)
        return result

    def _named(self, controllers: Controllers) -> dict[str, Controller]:
        if isinstance(controllers, Mapping):
            return dict(controllers)
        named: dict[str, Controller] = {}
        for controller in controllers:
            name = _WORDS.sub('_', type(controller).__name__).lower()
            if name in named:
                raise ConfigError(
                    f'two controllers are named {name}; give a mapping from names to controllers')
            named[name] = controller
        return named

    def _placed(self, named: Mapping[str, Controller]) -> list[Controller]:
        """Return controllers by name, those in the namespace of a robot for this one alone."""
        run = self.configuration
        return [of_its_robot(own, name, run, f'{self._config.name}: controllers.{name}')
                for name, own in named.items()]

    def _factories(self, body: Factories | None) -> Mapping[str, BodyFactory]:
        """Return what makes the external bodies, by name."""
        external = [own.name for own in self.configuration.bodies if own.is_given]
        if body is None:
            return {}
        if not isinstance(body, Mapping):
            if len(external) != 1:
                raise ConfigError(
                    f'{self._config.name}: body is one factory, the run has {len(external)} '
                    'bodies of the kind external')
            body = {external[0]: body}
        for name in body:
            if name not in external:
                raise ConfigError(
                    f'{self._config.name}: {name!r} is not a body of the kind external; '
                    f'{alternatives(name, external)}')
        return {name: imported_factory(own, 'body') if isinstance(own, str) else own
                for name, own in body.items()}

    def _with_names(self, names: Sequence[str]) -> Scenario:
        """
        Return the scenario with these controllers, among them all those of the run file.

        What a run on nodes prints before it begins is a `UserWarning`.
        """
        run = self.configuration
        for name in run.controllers:
            if name not in names:
                raise ConfigError(
                    f'{self._config.name}: controllers: {name!r} takes part in this run; give it '
                    'as one of the controllers')
        for line in self.scenario.warnings:
            warn(line)
        run = run.calling([own for own in run.called if own.name not in names])
        added = [name for name in names if name not in run.controllers]
        return replace(self.scenario, run=run.with_controllers(added))


def load(
        config: str | Path | Tree, scenario: str | Path | Tree | None = None, *,
        changes: Mapping[str, Any] | None = None, seed: int | None = None,
        duration: float | None = None, compression: str | None = None,
        split_mb: float | None = None) -> Run:
    """
    Return the run of a file, or of a shipped one by name, with its scenario.

    Instead of a file its content may be given, as a dictionary. ``changes`` are those of
    `Run.replace`, made before anything is checked: ``{'link': {'kind': 'can', ...}}`` for a
    scenario whose faults need a link. ``seed``, ``duration`` (s), ``compression`` and ``split_mb``
    are the options of `isa bringup`.

    Raises
    ------
    ConfigError
        A file cannot be read or is invalid; the message has file, key, value and bound.

    """
    changes = {} if changes is None else dict(changes)
    if seed is not None:
        changes['seed'] = seed
    return Run(
        *_changed(_file(config, CONFIG), None if scenario is None else _file(scenario, SCENARIOS),
                  changes), duration, compression, split_mb)


def _changed(
        config: _InputFile, scenario: _InputFile | None, changes: Mapping[str, Any]
        ) -> tuple[_InputFile, _InputFile | None]:
    """Return both files with other values; as `Run.replace`."""
    for key, value in changes.items():
        if not key.startswith(SCENARIO):
            config = config.replaced(key, value)
        elif scenario is None:
            raise ConfigError(f'{config.name}: {key} is not used: the run has no scenario')
        else:
            scenario = scenario.replaced(key.removeprefix(SCENARIO), value)
    return config, scenario


def _file(given: str | Path | Tree, directory: str) -> _InputFile:
    if isinstance(given, dict):
        name = given.get('name')
        return _InputFile(given, f'{name}.yaml' if isinstance(name, str) else 'the dictionary')
    path = find(str(given), directory)
    return _InputFile(read(path), path.name, path.parent)
