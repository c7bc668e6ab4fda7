"""
A run file and a scenario, simulated in this process without ROS, and its traces.

The same coordinator, recorder and bag reader as `isa bringup`, so the traces are those of
the bag that command would record. A study replaces parameters by their dotted path::

    experiment = run('rig_rotary', 'step', overrides={'rotor': {'plant.sensors.adc_bits': 10}})
    torque = experiment.traces['/rotor/joint_states']['effort[0]']
"""

from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from isa_ros.analysis.signals.traces import read_traces, Trace
from isa_ros.bag.provenance import installed_versions, Provenance
from isa_ros.bag.writer import BagWriter
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.run_config import ActuatorConfig, RunConfig
from isa_ros.config.run_file import load_run
from isa_ros.core.parameter import Parameters
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.run.local_run import Inputs, LocalRun
from isa_ros.scenario.scenario import idle, load_scenario, Scenario

Overrides = Mapping[str, Mapping[str, Any]]
"""Values in data-sheet units by actuator and dotted path: plant..., reu... or load...."""


class Experiment(NamedTuple):
    """What was simulated, and every topic of its bag."""

    run: RunConfig
    traces: dict[str, Trace]


def run(
        config: str | Path | RunConfig, scenario: str | Path | Scenario | None = None,
        out: Path | None = None, *, overrides: Overrides | None = None,
        duration: float | None = None) -> Experiment:
    """
    Simulate and record a run; ``out`` is the directory its bag stays in, None keeps none.

    ``config`` and ``scenario`` are files, shipped ones by name, or already read; a `Scenario`
    brings its own run. Without one every actuator holds where it is, and ``duration`` (s),
    which otherwise is the scenario's, must be given.

    Raises
    ------
    ConfigError
        The files or the overrides cannot be run.
    BagError
        ``out`` exists or cannot be made.
    SimulationDiverged
        A state is no longer finite.

    """
    plan = prepared(config, scenario, overrides)
    if duration is not None:
        plan = plan.lasting(duration)
    if plan.n_ticks is None:
        raise ConfigError(f'{plan.run.source}: an experiment needs a scenario or a duration')
    if out is not None:
        return _recorded(plan, plan.n_ticks, out)
    with TemporaryDirectory(prefix='isa_') as directory:
        return _recorded(plan, plan.n_ticks, Path(directory) / 'bag')


def prepared(
        config: str | Path | RunConfig, scenario: str | Path | Scenario | None,
        overrides: Overrides | None = None) -> Scenario:
    """Return what `run` simulates, with the overrides in it."""
    given = config if isinstance(config, RunConfig) else load_run(find(str(config), CONFIG))
    if scenario is None:
        plan = idle(given)
    elif isinstance(scenario, Scenario):
        plan = scenario
    else:
        plan = load_scenario(find(str(scenario), SCENARIOS), given)
    return replace(plan, run=with_overrides(plan.run, overrides or {}))


def with_overrides(run: RunConfig, overrides: Overrides) -> RunConfig:
    """
    Return a run with single parameters, or whole sections, of its actuators replaced.

    Raises
    ------
    ConfigError
        There is no such actuator or parameter, or the value is outside its range.

    """
    for name, values in overrides.items():
        changed = run.actuator(name)
        for path, value in values.items():
            changed = _override(changed, path, value, f'{run.source}: {name}')
        run = replace(run, actuators=tuple(
            changed if a.name == name else a for a in run.actuators))
    return run


def _override(actuator: ActuatorConfig, path: str, value: Any, where: str) -> ActuatorConfig:
    head, _, rest = path.partition('.')
    try:
        if head == 'load' and isinstance(actuator.load, Parameters):
            return replace(actuator, load=_replaced(actuator.load, rest, value, where))
        return replace(actuator, sheet=_replaced(actuator.sheet, path, value, where))
    except ParameterError as error:
        raise ParameterError(f'{where}.{path}: {error}') from error


def _replaced(parameters: Any, path: str, value: Any, where: str) -> Any:
    head, _, rest = path.partition('.')
    names = [f.name for f in fields(parameters)]
    if head not in names:
        raise ConfigError(f'{where}.{head} is unknown; {alternatives(head, names)}')
    if rest:
        below = getattr(parameters, head)
        if not isinstance(below, Parameters):
            raise ConfigError(f'{where}.{head} is one value, has no {rest}')
        value = _replaced(below, rest, value, f'{where}.{head}')
    return replace(parameters, **{head: value})


def _recorded(plan: Scenario, n_ticks: int, out: Path) -> Experiment:
    local = LocalRun(plan.run)
    provenance = Provenance(
        configuration=plan.run.to_yaml(), scenario=plan.to_yaml(), seed=0,
        versions=installed_versions())
    with BagWriter(out, local.topics, provenance) as bag:
        local.simulate(n_ticks, Inputs(plan.commands), bag)
    return Experiment(*read_traces(out))
