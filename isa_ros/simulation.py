"""
The model of a run as an object: numpy in, numpy out; without ROS, messages and bag.

    simulation = Simulation(load_scenario('drop.yaml', load_run('leg.yaml')))
    while simulation.t < 1.0:
        samples = simulation.step()
    print(samples['kfe'].force)

A tick is that of `isa_ros.run.coordinator`, in one thread and without waiting.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
import warnings

from isa_ros.config.assembly import group_of, request_range_of, surroundings_of
from isa_ros.controller import (
    by_name, Controller, ControllerSeat, fill_requests, merge_requests, Setpoint, State)
from isa_ros.core.noise import seed_of
from isa_ros.core.saved_state import RunState
from isa_ros.core.signals import COMMAND, LOAD_PORT, Records
from isa_ros.core.suggest import alternatives
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.scenario.faults import ParameterChanges
from isa_ros.scenario.scenario import Scenario
import numpy as np

_SNAPSHOT = 'snapshot'


class Simulation:
    """
    A run in memory, advanced tick by tick; it begins at t = 0.

    Commands come from the scenario, from `command`, and from ``controllers``, whose commands
    depend on the state of a tick and take effect one tick later. At the same tick the scenario
    wins over a controller, and both over `command`. A request of a controller beyond the range of
    its actuator is refused or limited, with a `UserWarning`.

    Raises
    ------
    ConfigError
        The run cannot be assembled.

    """

    def __init__(self, scenario: Scenario, controllers: Sequence[Controller] = ()) -> None:
        self._controllers = tuple(controllers)
        self._seats: list[ControllerSeat] = []
        self._assemble(scenario)
        self.reset()

    def _assemble(self, scenario: Scenario) -> None:
        """Create actuators and surroundings, and the views on their rows."""
        self.scenario = scenario
        run = scenario.run
        self.names = tuple(actuator.name for actuator in run.actuators)
        """Names of the actuators, in the order of all rows."""
        self.group = group_of(run)
        """The actuators, with their samples as rows."""
        self.surroundings = surroundings_of(run)
        """Supplies and body, with their samples as rows."""
        self._starts, self._beginning = (
            self.surroundings.starts(), self.surroundings.snapshot())
        n = len(self.names)
        self._ports: Records = np.zeros(n, LOAD_PORT)
        self._commands: Records = np.zeros(n, COMMAND)
        self._requests: Records = np.zeros(n, COMMAND)
        self.samples: Mapping[str, np.record] = by_name(self.names, self.group.samples)
        """`SAMPLE` by actuator at the end of the last tick; the next one overwrites them."""
        self.observed: Mapping[str, np.record] = by_name(self.names, self.group.observed)
        """The same as listeners have it: behind a link the newest that has arrived."""
        self.supply_samples: Mapping[str, np.record] = by_name(
            [feed.name for feed in self.surroundings.feeds], self.surroundings.supplies)
        """`SUPPLY_SAMPLE` by supply, likewise."""
        self.body_sample: np.record | None = None
        """Sample of the body, likewise; None without a body."""
        if self.surroundings.body is not None:
            self.body_sample = self.surroundings.body.sample.view(np.recarray)[0]

    def reset(self, seed: int | None = None) -> Mapping[str, np.record]:
        """
        Start again at t = 0 and return the `samples` at t = 0.

        Tuned values are in force again from the first tick on. With a ``seed`` the noise is that
        of the run with this seed: actuators and all samples are new objects, tuned values and
        commands that are not yet in force are forgotten.

        Raises
        ------
        ConfigError
            The seed is not a whole number >= 0.

        """
        if seed is not None:
            run = replace(self.scenario.run, seed=seed_of(seed, 'seed'))
            self._assemble(replace(self.scenario, run=run))
        self.ticks = 0
        self.surroundings.restart(self._beginning)
        self.group.start(self._starts)
        self._requests['kinds'] = 0
        self._seats = [ControllerSeat(own, self.names) for own in self._controllers]
        if self._seats:
            self._request_range = request_range_of(self.scenario.run)
        return self.samples

    @property
    def t_ns(self) -> int:
        """Return the simulated time, ns."""
        return self.ticks * self.scenario.run.step_ns

    @property
    def t(self) -> float:
        """Return the simulated time, s."""
        return self.t_ns / NS_PER_SECOND

    def command(self, name: str, **setpoint: float | bool | str | None) -> None:
        """
        Command an actuator; it takes effect at the next tick.

        The fields are those of `Setpoint`: ``position`` (m or rad), ``velocity``, ``effort``,
        ``stiffness``, ``damping``, ``is_enabled``; ``mode``, and ``current`` (A), ``spool`` (m) or
        ``pressure`` (Pa) in the mode of that name; ``clear_fault``, ``quick_stop``.

        Raises
        ------
        SetpointError
            The run has no such actuator, a value is invalid, not of the mode, or beyond the
            range of the actuator; with ``beyond_range: limit`` that is a `UserWarning` instead.

        """
        row: Records = np.zeros(len(self.names), COMMAND)
        fill_requests({name: Setpoint(**setpoint)}, self.names, row)  # type: ignore[arg-type]
        at = self.names.index(name)
        actuator = self.group.actuators[at]
        if limited := actuator.admit(row[at]):
            warnings.warn(limited, stacklevel=2)

    def tune(self, name: str, values: Mapping[str, float]) -> None:
        """
        Change parameters of an actuator or a supply; they take effect at the next tick.

        Values by the keys and in the units of `isa params`: ``tune('kfe', {'reu.force.kp': 1e-7,
        'plant.spool.stuck': 1})``, ``tune('supply', {'pressure_mpa': 10.0})``. All values are
        accepted, or none.

        Raises
        ------
        ConfigError
            There is no such actuator or supply, a key is unknown, or a value is refused.

        """
        if name in self.supply_samples:
            self.surroundings.tune({f'{name}.{key}': value for key, value in values.items()})
        else:
            if name not in self.names:
                known = [*self.names, *self.supply_samples]
                raise ConfigError(
                    f'{name!r} is not an actuator or a supply; {alternatives(name, known)}')
            self.group.actuators[self.names.index(name)].tune(values)

    def step(self, commands: Records | None = None) -> Mapping[str, np.record]:
        """
        Advance one tick and return the `samples` at its end.

        ``commands`` are `COMMAND` rows, (n_actuators,), used instead of those of the scenario.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.

        """
        commands = self._merged(commands)
        if self._seats:
            self._control()
        changes = self.scenario.changes_at(self.ticks)
        if changes is not None:
            self._change(changes)
        self.surroundings.ports(self._ports)
        self.surroundings.advance(self.group.advance(self._ports, commands))
        self.ticks += 1
        return self.samples

    def _change(self, changes: ParameterChanges) -> None:
        """Let the faults of this tick begin and end."""
        self.surroundings.tune(changes.supplies)
        for row, values in changes.actuators.items():
            self.group.actuators[row].tune(values)

    def _merged(self, given: Records | None) -> Records | None:
        """Return the controllers' requests, overwritten by given or by the scenario's commands."""
        is_commanded = given is None and self.scenario.has_commands_at(self.ticks)
        if not (is_commanded or self._seats):
            return given
        self._commands, self._requests = self._requests, self._commands
        self._requests['kinds'] = 0
        if self._seats:
            for line in self._request_range.admit(self.t_ns, self._commands):
                warnings.warn(line, stacklevel=3)
        if is_commanded:
            self.scenario.commands(self.ticks, self._commands)
        if given is not None:
            merge_requests(given, self._commands)
        return self._commands

    def _control(self) -> None:
        """Call the controllers with the state before the tick; store requests for the next."""
        state = State(self.t_ns, self.observed, self.supply_samples, self.body_sample)
        for seat in self._seats:
            seat.step(state, self._requests)

    def state(self) -> RunState:
        """
        Return the complete state of the run, in the form that a run on nodes saves.

        Raises
        ------
        RunError
            A controller cannot be saved.

        """
        return RunState(
            tick=self.ticks, load=self.surroundings.snapshot(),
            participants=[*(actuator.snapshot() for actuator in self.group.actuators),
                          *(seat.controller.snapshot() for seat in self._seats)],
            requests=self._requests.tobytes())

    def resume(self, state: RunState) -> None:
        """
        Continue from a `state` of the same configuration.

        Raises
        ------
        ConfigError
            The state is not one of this configuration.

        """
        n = len(self.names)
        if len(state.participants) != n + len(self._seats):
            raise ConfigError(
                f'the saved state has {len(state.participants)} participants, the run has '
                f'{n + len(self._seats)}')
        self.ticks = state.tick
        self.surroundings.restore(state.load)
        self._requests[:] = state.rows_of_requests(n)
        for actuator, own in zip(self.group.actuators, state.participants):
            actuator.restore(own)
        for seat, own in zip(self._seats, state.participants[n:]):
            seat.controller.restore(own)

    def snapshot(self) -> bytes:
        """Return the complete state as bytes for `restore`; raises as `state`."""
        return self.state().to_json(self.scenario.run.digest, {}).encode()

    def restore(self, snapshot: bytes) -> Mapping[str, np.record]:
        """Continue from a `snapshot` and return its `samples`; raises as `resume`."""
        self.resume(RunState.from_json(
            snapshot.decode(), self.scenario.run.digest, _SNAPSHOT))
        return self.samples

    @property
    def applied(self) -> Records:
        """Return the commands applied at the start of the last tick; `ActuatorGroup.applied`."""
        return self.group.applied

    @property
    def tuned(self) -> Mapping[int, Mapping[str, float]]:
        """Return the parameters that changed at the same time; `ActuatorGroup.tuned`."""
        return self.group.tuned

    @property
    def tuned_supplies(self) -> Mapping[str, float]:
        """Return the supplies' parameters that changed at the same time, by SUPPLY.KEY."""
        return self.surroundings.tuned
