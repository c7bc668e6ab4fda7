"""A whole run in this process, without ROS: a simulation with a recorder."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.saved_state import RunState
from isa_ros.core.signals import COMMAND, Records
from isa_ros.run.coordinator import Interrupted
from isa_ros.run.exchange import Recorder
from isa_ros.run.narrator import Narrator, packer_of
from isa_ros.run.packing import Shown
from isa_ros.run.thinning import Thinning
from isa_ros.scenario.scenario import idle, Scenario
from isa_ros.simulation import Simulation
import numpy as np

Tuned = Mapping[int, Mapping[str, float]]
"""Tick -> new values of an actuator's parameters, SI, by name."""


class Inputs(NamedTuple):
    """External inputs of a run, by tick."""

    commands: Callable[[int, Records], None]
    """Overwrites `COMMAND` rows of a tick."""
    tuned: Mapping[str, Tuned] = {}
    """Changes of parameters, by actuator."""
    events: Mapping[int, Sequence[str]] = {}
    """Texts of the events recorded before a tick."""
    has_end: bool = True
    """Whether the diagnostics of the last instant are recorded, as at the end of a run."""
    tuned_supplies: Tuned = {}
    """Changes of the supplies' parameters, by SUPPLY.KEY."""


def inputs_of(scenario: Scenario) -> Inputs:
    """Return the commands and the faults of a scenario."""
    tuned: dict[str, dict[int, Mapping[str, float]]] = {}
    for tick, changes in scenario.changes.items():
        for row, values in changes.actuators.items():
            tuned.setdefault(scenario.run.actuators[row].name, {})[tick] = values
    return Inputs(scenario.commands, tuned, tuned_supplies={
        tick: changes.supplies for tick, changes in scenario.changes.items()})


class LocalRun:
    """
    A run ready to be simulated and recorded; ``topics`` are the recorded ones, in order.

    Its controllers do not take part: their requests are among the commands.
    """

    def __init__(self, run: RunConfig) -> None:
        self._run = replace(run, controllers=())
        self._simulation = Simulation(idle(self._run))
        self._packer = packer_of(self._run, shown(self._simulation))
        self._thinning = Thinning(run.record, self._packer.topics)
        self.topics = self._thinning.topics

    def simulate(
            self, n_ticks: int, inputs: Inputs, recorder: Recorder,
            should_stop: Callable[[], bool] = lambda: False,
            state: RunState | None = None) -> None:
        """
        Pass every sample until t = ``n_ticks`` step_ns to ``recorder``; call this once.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.
        Interrupted
            ``should_stop`` was true before the end.

        """
        simulation = self._simulation
        if state is not None:
            simulation.resume(state)
        narrator = Narrator(self._packer, self._run.step_ns, self._thinning.recorder(recorder))
        commands = np.zeros(len(simulation.names), COMMAND)
        while True:
            narrator.publish_rows(
                simulation.ticks, simulation.tuned, simulation.tuned_supplies)
            for text in inputs.events.get(simulation.ticks, ()):
                narrator.add_event(simulation.ticks, text)
            if simulation.ticks >= n_ticks:
                narrator.end() if inputs.has_end else narrator.record()
                return
            narrator.record()
            if should_stop():
                raise Interrupted(f'stopped after {simulation.ticks} ticks')
            self._tune(inputs)
            commands['kinds'] = 0
            inputs.commands(simulation.ticks, commands)
            simulation.step(commands)

    def _tune(self, inputs: Inputs) -> None:
        """Set the parameters that change at the next tick, as a user of the nodes would."""
        simulation = self._simulation
        simulation.surroundings.tune(inputs.tuned_supplies.get(simulation.ticks, {}))
        for name, by_tick in inputs.tuned.items():
            values = by_tick.get(simulation.ticks)
            if values is not None:
                simulation.group.actuators[simulation.names.index(name)].tune(values)


def shown(simulation: Simulation) -> Shown:
    """Return the rows of a simulation that its messages are packed from."""
    body = simulation.surroundings.body
    return Shown(
        simulation.group.observed, simulation.group.applied, simulation.surroundings.supplies,
        None if body is None else body.sample, simulation.group.sent)
