"""The actuators of a run in a loop that somebody else owns: another simulator, a rig, a game."""

from collections.abc import Sequence
from typing import Any

from isa_ros.actuator.setpoint_range import Beyond, load_positions
from isa_ros.config.runs.external_config import refuse_force, refuse_start
from isa_ros.core.signals import Records
from isa_ros.errors import ConfigError
from isa_ros.scripting.log import LogSink
from isa_ros.scripting.result import Result, result_of
from isa_ros.scripting.run import Controllers, Run
from isa_ros.simulation import Simulation
from isa_ros.surroundings.callers import numbers_of
from isa_ros.surroundings.kept_ports import FORMAT, GivenBody
from isa_ros.surroundings.mechanism import Mounting
import numpy as np
from numpy.typing import ArrayLike, NDArray

_FIRST_TICKS = 1000     # samples before the log grows


class Actuators:
    """
    The actuators on the external body of a run, advanced tick by tick by the caller.

        actuators = isa_ros.Actuators(run)
        actuators.start(position, force)
        while data.time < 1.0:
            for forces in actuators.advance(position, velocity, acceleration):
                ...                         # a fifth of a tick of the caller's simulator

    Arrays have a number for each of the k actuators, in the order of the body's list in the run
    file. Supplies, scenario, faults, links and controllers are those of the run.

    Raises
    ------
    ConfigError
        The run has not exactly one body of the kind external.

    """

    def __init__(self, run: Run, controllers: Controllers = ()) -> None:
        external = [body for body in run.configuration.bodies if body.is_given]
        if len(external) != 1:
            raise ConfigError(
                f'{run.configuration.source}: Actuators needs one body of the kind external, the '
                f'run has {len(external)}')
        self._run, self._controllers = run, controllers
        self.names: Sequence[str] = tuple(actuator for _, actuator in external[0].joints)
        """Of the actuators, in the order of all arrays."""
        self._port: Records = np.zeros(len(self.names), FORMAT)
        self._simulation: Simulation | None = None
        self._log: LogSink | None = None
        self._rows: NDArray[np.int64] = np.zeros(0, np.int64)
        sheets = [run.configuration.actuator(name).sheet for name in self.names]
        self._places = [load_positions(sheet) for sheet in sheets]
        self._lowest, self._highest = np.array([own[:2] for own in self._places]).T

    def start(self, position: ArrayLike | None = None, force: ArrayLike | None = None) -> None:
        """
        Begin a run at t = 0 with the load at rest.

        ``position`` of the load's side of each force sensor, m | rad, (k,); None: that of the run
        file, ``initial_position_mm`` or ``_deg``. ``force`` that each actuator bears, N | Nm,
        (k,); None: 0. A second call begins another run.

        Raises
        ------
        ConfigError
            A position is outside the stroke of its actuator, its relief valves would open under a
            force, or a number is not finite.

        """
        configured = {own.name: own for own in self._run.configuration.actuators}
        own = [configured[name] for name in self.names]
        self._port['x0'] = ([each.initial_position for each in own] if position is None
                            else numbers_of(self.names, 'position', position))
        self._port['force'] = 0.0 if force is None else numbers_of(
            self.names, 'force', force)
        for each, place in zip(own, self._port['x0'].tolist()):
            refuse_start(each, place)
        for each, borne in zip(own, self._port['force'].tolist()):
            refuse_force(each, borne)
        simulation = self._run.simulation(self._controllers, body=self._body)
        self._log = LogSink(simulation, _FIRST_TICKS)
        simulation.loop.sinks = (self._log,)
        simulation.loop.begin()
        self._simulation = simulation

    def _body(self, mounting: Mounting) -> GivenBody:
        self._rows = mounting.rows
        return GivenBody(mounting.rows, lambda number: self._port)

    def advance(
            self, position: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike, *,
            inverse_mass: ArrayLike | None = None, a_bias: ArrayLike | None = None,
            jerk: ArrayLike | None = None, stiffness: ArrayLike | None = None,
            damping: ArrayLike | None = None) -> NDArray[np.float64]:
        """
        Advance one tick; return the mean force in each sensor over each fifth of it, (5, k).

        The motion of the load at the start of the tick: m | rad, m/s | rad/s, m/s2 | rad/s2, each
        (k,). It goes on as x'' = a_bias + jerk t + inverse_mass f - stiffness e - damping e'
        (equation L1), where f is the actuator's own force, e the departure from the motion with
        constant acceleration; ``a_bias`` is that acceleration without f: None: ``acceleration``
        less inverse_mass times the force at the end of the last tick. The others default to 0.

        Raises
        ------
        ConfigError
            `start` was not called, a number is not finite, or a position is farther beyond an end
            of the stroke than half of it.
        SimulationDiverged
            A state is no longer finite.

        """
        simulation = self._started
        port = self._port
        for name, given in (
                ('x0', position), ('v0', velocity), ('a0', acceleration),
                ('inverse_mass', inverse_mass), ('jerk', jerk), ('stiffness', stiffness),
                ('damping', damping)):
            port[name] = 0.0 if given is None else numbers_of(
                self.names, {'x0': 'position', 'v0': 'velocity', 'a0': 'acceleration'}.get(
                    name, name), given)
        self._refuse_far()
        for name, mass in zip(self.names, port['inverse_mass'].tolist()):
            if mass < 0.0:
                raise ConfigError(f'{name}: inverse_mass = {mass:g}, must be >= 0')
        port['a_bias'] = (port['a0'] - port['inverse_mass'] * self.forces if a_bias is None
                          else numbers_of(self.names, 'a_bias', a_bias))
        simulation.step()
        means: NDArray[np.float64] = simulation.loop.rows.replies['mean_forces'][self._rows]
        return means.T.copy()

    def _refuse_far(self) -> None:
        """Refuse a position that is far outside the stroke, before it breaks the tick."""
        place = self._port['x0']
        is_far = (place < self._lowest) | (place > self._highest)
        for k in np.flatnonzero(is_far).tolist():
            found = Beyond('x0', 'position', float(place[k]), self._places[k])
            raise ConfigError(f'{self.names[k]}: {found.shown}, {found.refusal}')

    @property
    def forces(self) -> NDArray[np.float64]:
        """Return the force in each sensor at the end of the last tick, N | Nm, (k,)."""
        if self._started.ticks == 0:
            start: NDArray[np.float64] = self._port['force'].copy()
            return start
        forces: NDArray[np.float64] = self._started.loop.rows.replies['force'][self._rows]
        return forces

    def command(self, name: str, **setpoint: Any) -> None:
        """Command an actuator; as `isa_ros.Simulation.command`."""
        self._started.command(name, **setpoint)

    @property
    def simulation(self) -> Simulation:
        """Return the simulation below, with its samples; advance it only by `advance`."""
        return self._started

    @property
    def _started(self) -> Simulation:
        if self._simulation is None:
            raise ConfigError('Actuators: call start before this')
        return self._simulation

    @property
    def result(self) -> Result:
        """Return all samples so far; its bag replays without the caller's simulator."""
        simulation = self._started
        assert self._log is not None, 'made with the simulation'
        return result_of(simulation, self._log)
