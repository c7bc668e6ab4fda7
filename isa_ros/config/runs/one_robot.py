"""
One robot of a run, as if it were alone: its parts by the names of its own file.

A controller ``r1/trot`` is made for the robot ``r1`` and sees no other: what is ``r1/kfe`` in the
run is ``kfe`` for it, and the body ``r1`` is the body. A supply of the run that feeds the robot
keeps its name.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from isa_ros.config.text.names import parted, placed
from isa_ros.controller import Controller, Setpoint, Setpoints, State
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError


def one_robot(run: Any, robot: str, where: str) -> Any:
    """
    Return the `RunConfig` of one robot of a run, without controllers.

    Raises
    ------
    ConfigError
        No actuator is in its namespace; ``where`` names what asks for it.

    """
    fed = [own.name for own in run.actuators if parted(own.name)[0] == robot]
    if not fed:
        robots = [*dict.fromkeys(filter(None, (parted(own.name)[0] for own in run.actuators)))]
        raise ConfigError(
            f'{where}: no actuator is in the namespace {robot!r}; {alternatives(robot, robots)}')
    return replace(
        run, controllers=(), called=(), emergency_stops=(),
        actuators=tuple(replace(own, name=_name_in(robot, own.name))
                        for own in run.actuators if own.name in fed),
        bodies=tuple(own.out_of_namespace(robot) for own in run.bodies
                     if own.name == robot or parted(own.name)[0] == robot),
        supplies=tuple(
            replace(own, name=_name_in(robot, own.name),
                    feeds=tuple(_name_in(robot, name) for name in own.feeds if name in fed))
            for own in run.supplies if set(own.feeds) & set(fed)))


def _name_in(robot: str, name: str) -> str:
    namespace, own = parted(name)
    return own if namespace == robot else name


class RobotController(Controller):
    """
    The controller of one robot in a run of several.

    ``run`` is the `RunConfig` of all, ``where`` for messages; raises as `one_robot`.
    """

    def __init__(self, own: Controller, robot: str, run: Any, where: str) -> None:
        alone = one_robot(run, robot, where)
        self._own, self._robot = own, robot
        self._names = [actuator.name for actuator in alone.actuators]
        self._rows = [run.index(placed(robot, name)) for name in self._names]
        self._supplies = {_name_in(robot, supply.name): supply.name for supply in run.supplies
                          if _name_in(robot, supply.name) in [one.name for one in alone.supplies]}
        self._bodies = {body.out_of_namespace(robot).name: body.name for body in run.bodies
                        if body.name == robot or parted(body.name)[0] == robot}
        self._every: Mapping[str, Any] | None = None

    @property
    def __wrapped__(self) -> Controller:
        """Return the controller of the robot alone."""
        return self._own

    def start(self, names: Sequence[str]) -> None:
        """Begin anew with the actuators of the robot; as `Controller.start`."""
        self._own.start(list(self._names))

    def step(self, state: State) -> Mapping[str, Setpoint] | Setpoints:
        """Return the setpoints of the robot by the names of the run; as `Controller.step`."""
        if self._every is not state.actuators:      # the records of a run stay
            self._every = state.actuators
            self._seen = State(
                0, {name: state.actuators[placed(self._robot, name)] for name in self._names},
                {name: state.supplies[key] for name, key in self._supplies.items()},
                {name: state.bodies[key] for name, key in self._bodies.items()})
        found = self._own.step(self._seen._replace(t_ns=state.t_ns, rows=state.rows[self._rows]))
        if isinstance(found, Setpoints):
            return found._replace(names=[placed(self._robot, name) for name in found.names])
        if not isinstance(found, Mapping):
            return found        # refused as what any controller returns
        return {placed(self._robot, str(name)): own for name, own in found.items()}

    def snapshot(self) -> bytes:
        """Return the state of the controller."""
        return self._own.snapshot()

    def restore(self, snapshot: bytes) -> None:
        """Continue from a `snapshot`."""
        self._own.restore(snapshot)


def of_its_robot(controller: Controller, name: str, run: Any, where: str) -> Controller:
    """Return the controller of a name in a run, for one robot if it is in a namespace."""
    robot, _ = parted(name)
    return RobotController(controller, robot, run, where) if robot else controller
