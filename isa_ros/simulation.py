"""
The model of a run as an object: numpy in, numpy out; without ROS, messages and bag.

    simulation = Simulation(load_scenario('drop.yaml', load_run('leg.yaml')))
    while simulation.t < 1.0:
        samples = simulation.step()
    print(samples['kfe'].force)

A tick is that of every run (`isa_ros.tick.tick_loop`), in one thread and without waiting.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from isa_ros.config.assembly import group_of, request_range_of, surroundings_of
from isa_ros.config.runs.body_config import BodyFactory
from isa_ros.controller import by_name, Controller, only_of, only_rows, Setpoint
from isa_ros.core.caller import warn
from isa_ros.core.noise import seed_of
from isa_ros.core.saved_state import RunState
from isa_ros.core.signals import COMMAND, Records
from isa_ros.core.suggest import alternatives
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError, IsaError
from isa_ros.requests import fill_requests, refuse_without_effort
from isa_ros.scenario.scenario import Scenario
from isa_ros.tick.calling import CallingTransport
from isa_ros.tick.emergency_stop import emergency_stops_of
from isa_ros.tick.exchange import Rows, Transport
from isa_ros.tick.in_process import InProcess
from isa_ros.tick.source import ScheduledSource
from isa_ros.tick.tick_loop import TickLoop
import numpy as np

_SNAPSHOT = 'snapshot'


class Simulation:
    """
    A run in memory, advanced tick by tick; it begins at t = 0.

    Commands come from the scenario, from `command`, and from ``controllers`` and those of the run,
    whose commands depend on the state of a tick and take effect one tick later. At the same tick
    the scenario wins over a controller, and both over `command`. A request of a controller beyond
    the range of its actuator is refused or limited, with a `UserWarning`. ``factories`` make the
    bodies of the kind external, by name; None: the class in the run file.

    Raises
    ------
    ConfigError
        The run cannot be assembled.

    """

    def __init__(
            self, scenario: Scenario, controllers: Sequence[Controller] = (),
            factories: Mapping[str, BodyFactory] = MappingProxyType({})) -> None:
        self._controllers, self._factories = tuple(controllers), factories
        self._assemble(scenario)
        self.reset()

    def _assemble(self, scenario: Scenario) -> None:
        """Create actuators and surroundings, and the views on their rows."""
        scenario.refuse_bus()
        self.scenario = scenario
        run = scenario.run
        self.names = tuple(actuator.name for actuator in run.actuators)
        """Names of the actuators, in the order of all rows."""
        self.group = group_of(run)
        """The actuators, with their samples as rows."""
        self.surroundings = surroundings_of(run, self._factories)
        """Supplies and bodies, with their samples as rows."""
        supplies = [own.name for own in run.sampled_supplies]
        transport: Transport = InProcess(self.group, self.surroundings.starts())
        controllers = [*self._controllers, *(own.made(run) for own in run.called)]
        if controllers:
            transport = CallingTransport(
                transport, controllers, self.names, supplies, run.step_ns,
                [*(type(own).__name__ for own in self._controllers),
                 *(own.called for own in run.called)])
        self.loop = TickLoop(
            run.step_ns, transport, self.surroundings,
            Rows(len(self.names), self.surroundings, self.group),
            ScheduledSource(scenario.commands, scenario.changes,
                            next_command=scenario.next_command),
            stops=emergency_stops_of(run, self.surroundings),
            request_range=request_range_of(run) if controllers else None, warn=warn)
        """The ticks of the run; its sinks take the rows of each instant."""
        self.samples: Mapping[str, np.record] = by_name(self.names, self.group.samples)
        """`SAMPLE` by actuator at the end of the last tick; the next one overwrites them."""
        self.observed: Mapping[str, np.record] = by_name(self.names, self.group.observed)
        """The same as listeners have it: behind a link the newest that has arrived."""
        self.supply_samples: Mapping[str, np.record] = by_name(
            supplies, self.surroundings.supplies)
        """`SUPPLY_SAMPLE` by supply, likewise."""
        self.body_samples: Mapping[str, np.record] = only_rows(self.loop.rows.bodies)
        """Sample of each body by name, likewise."""

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
        self.loop.join()
        return self.samples

    @property
    def body_sample(self) -> np.record | None:
        """Return the sample of the only body; None without one, or with several."""
        return only_of(self.body_samples)

    @property
    def ticks(self) -> int:
        """Return the number of finished ticks."""
        return self.loop.ticks

    @property
    def t_ns(self) -> int:
        """Return the simulated time, ns."""
        return self.loop.t_ns

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
        given = Setpoint(**setpoint)  # type: ignore[arg-type]
        fill_requests({name: given}, self.names, row)
        at = self.names.index(name)
        actuator = self.group.actuators[at]
        refuse_without_effort(name, given, actuator.mode)
        if limited := actuator.admit(row[at]):
            warn(limited)

    def tune(self, name: str, values: Mapping[str, float]) -> None:
        """
        Change parameters of an actuator, a supply or a body; they take effect at the next tick.

        Values by the keys and in the units of `isa params`: ``tune('kfe', {'reu.force.kp': 1e-7,
        'plant.spool.stuck': 1})``, ``tune('supply', {'pressure_mpa': 10.0})``, ``tune('body',
        {'push_y': 500.0})``. All values are accepted, or none.

        Raises
        ------
        ConfigError
            There is no such actuator, supply or body, a key is unknown, or a value is refused.

        """
        if name in self.supply_samples or name in self.surroundings.bodies:
            self.surroundings.tune({f'{name}.{key}': value for key, value in values.items()})
        else:
            if name not in self.names:
                known = [*self.names, *self.supply_samples, *self.surroundings.bodies]
                raise ConfigError(
                    f'{name!r} is not an actuator, a supply or a body; '
                    f'{alternatives(name, known)}')
            self.group.actuators[self.names.index(name)].tune(values)

    def emergency_stop(self, is_open: bool = True, group: str | None = None) -> None:
        """
        Open the line of an emergency stop, or close it again, from the next tick on.

        ``group`` is one of the run file's `emergency_stops`; None: all of them. What has stopped
        is enabled by `command`.

        Raises
        ------
        ConfigError
            There is no such group, or a trip would open the line again: clear it first.

        """
        assert self.loop.stops is not None, 'given by _assemble'
        self.loop.stops.request(is_open, self.loop.rows.samples, group)

    def step(self, commands: Records | None = None) -> Mapping[str, np.record]:
        """
        Advance one tick and return the `samples` at its end.

        ``commands`` are `COMMAND` rows, (n_actuators,), used instead of those of the scenario.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.

        """
        self.loop.advance(commands)
        return self.samples

    def state(self) -> RunState:
        """
        Return the complete state of the run, in the form that a run on nodes saves.

        Raises
        ------
        RunError
            A controller cannot be saved.

        """
        return self.loop.save()

    def resume(self, state: RunState) -> None:
        """
        Continue from a `state` of the same configuration, or change nothing.

        A run whose own state cannot be saved, as after `SimulationDiverged`, is left half
        restored where the new one is refused.

        Raises
        ------
        ConfigError
            The state is not one of this configuration.
        RunError
            A controller or an external body refuses its part.

        """
        before = self._state_if_any()
        try:
            self.loop.restore(state)
        except IsaError:
            if before is not None:
                self.loop.restore(before)
            raise

    def _state_if_any(self) -> RunState | None:
        """Return the state; None: it cannot be saved."""
        try:
            return self.state()
        except IsaError:
            return None

    def snapshot(self) -> bytes:
        """Return the complete state as bytes for `restore`; raises as `state`."""
        return self.state().to_json(self.scenario.run.digest, {}).encode()

    def restore(self, snapshot: bytes) -> Mapping[str, np.record]:
        """Continue from a `snapshot` and return its `samples`; raises as `resume`."""
        try:
            text = snapshot.decode()
        except UnicodeDecodeError:
            raise ConfigError(f'{_SNAPSHOT} is not a saved state of a run') from None
        self.resume(RunState.from_json(text, self.scenario.run.digest, _SNAPSHOT))
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
