"""
Roles of a participant of the lockstep: to simulate an actuator, or to run a controller.

A role executes the steps of the coordinator and returns the parts of its answer, as bytes: an
actuator's are its rows and the parameters that changed (`wire.parts`), a controller's
are the `COMMAND` rows that it requests.
"""

from collections.abc import Mapping, Sequence
from typing import Protocol

from isa_ros.controller import by_name, Controller, only_rows, State
from isa_ros.core.signals import COMMAND, Records
from isa_ros.errors import SetpointError
from isa_ros.nodes.actuator.node import ActuatorNode
from isa_ros.requests import fill_requests
from isa_ros.run.wire.parts import actuator_parts, Parts
from isa_ros.run.wire.roster import Roster
from isa_ros.run.wire.steps import Step
from isa_ros.surroundings.callers import at_step
import numpy as np


class Role(Protocol):
    """Executes the steps of one participant."""

    is_actuator: bool
    """Whether a hello must list it among the actuators, or among the controllers."""

    @property
    def digest(self) -> bytes:
        """Return a hash of its parameters; empty: not compared."""
        ...

    def start(self, step: Step, index: int) -> Parts:
        """Start at t = 0 with the data of a hello for the participant at ``index``."""
        ...

    def check(self, step: Step) -> None:
        """
        Refuse a tick before it is executed.

        Raises
        ------
        WireError
            It does not fit the run, or has a number that is not finite.

        """
        ...

    def advance(self, step: Step) -> Parts:
        """
        Execute one tick.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.

        """
        ...

    def change(self, values: Mapping[str, float]) -> Parts:
        """Change parameters at the start of the next tick; return no parts."""
        ...

    def publish(self) -> None:
        """Publish the results of the last answer, where there is a subscription."""
        ...

    def serve(self) -> None:
        """Process messages that have arrived on other topics and services; do not wait."""
        ...

    def snapshot(self) -> bytes:
        """Return the complete state."""
        ...

    def restore(self, snapshot: bytes) -> Parts:
        """Continue from a `snapshot`."""
        ...


class ActuatorRole:
    """The role of the actuator of a node."""

    is_actuator = True

    def __init__(self, node: ActuatorNode) -> None:
        self._actuator = node.actuator
        self._n_actuators = 0
        self.index = 0
        """Its row in the run."""
        self.has_feed = False
        """Whether the supplies of its run have ports."""
        self._changes: Mapping[str, float] = {}
        self.digest = node.digest.encode()
        self.publish = node.publish
        self.serve = node.serve
        self.snapshot = node.actuator.snapshot

    def start(self, step: Step, index: int) -> Parts:
        """Start at rest, at t = 0, from its `START` row."""
        self.index, self._n_actuators = index, step.rows
        self.has_feed = step.roster().has_supply_ports
        self._actuator.start(*step.start(index).item())
        return self.parts()

    def check(self, step: Step) -> None:
        """Refuse a tick of another number of actuators, or with invalid numbers."""
        step.refuse_tick(self._n_actuators, self.index)
        if self.has_feed:
            step.refuse_feed(self.index)

    def advance(self, step: Step) -> Parts:
        """Advance one tick with its row of ports and commands, and the changes before it."""
        if self._changes:   # after `serve`: the scenario wins over other requests
            self._actuator.tune(self._changes)
            self._changes = {}
        command = step.command(self.index)
        if command['kinds']:
            self._actuator.accept(command)
        if self.has_feed:
            self._actuator.memory.feeds[0] = step.feed(self.index)
        self._actuator.tick(step.port(self.index))
        return self.parts()

    @property
    def is_settled(self) -> bool:
        """Return whether the next tick changes no parameter, and answers with none."""
        return not self._changes and self._actuator.is_settled

    def change(self, values: Mapping[str, float]) -> Parts:
        """Keep the changes for the next tick."""
        self._changes = values
        return ()

    def restore(self, snapshot: bytes) -> Parts:
        """Continue from a snapshot."""
        self._actuator.restore(snapshot)
        return self.parts()

    def parts(self) -> Parts:
        """Return the parts of the answer to the last tick."""
        own = self._actuator.memory
        return actuator_parts(own.replies, own.observed, own.applied,
                              self._actuator.applied_parameters, own.sent,
                              own.fed if self.has_feed else None)


class ControllerRole:
    """The role of a user's controller."""

    digest = b''
    is_actuator = False

    def __init__(self, controller: Controller) -> None:
        self._controller = controller
        self._names: Sequence[str] = ()
        self._requests: Records = np.zeros(0, COMMAND)
        self._roster = Roster((), (), {})
        self._step_ns = 0

    def start(self, step: Step, index: int) -> Parts:
        """Start the controller with the names of the actuators; return no requests yet."""
        self._roster, self._step_ns = step.roster(), step.step_ns()
        self._names = self._roster.names[:step.rows]
        self._controller.start(list(self._names))
        self._requests = np.zeros(step.rows, COMMAND)
        return self._parts()

    def check(self, step: Step) -> None:
        """Refuse a tick that does not show the state of the run."""
        step.refuse_state(len(self._names), self._roster)

    def advance(self, step: Step) -> Parts:
        """Call the controller with the state before the tick; return commands for the next one."""
        found = step.state(self._roster)
        self._requests['kinds'] = 0
        state = State(
            step.tick * self._step_ns, by_name(self._names, found.samples),
            by_name(self._roster.supplies, found.supplies), only_rows(found.bodies),
            found.samples)
        setpoints = self._controller.step(state)
        try:
            fill_requests(setpoints, self._names, self._requests, state.actuators)
        except SetpointError as error:
            raise SetpointError(at_step(error, self._controller)) from error
        return self._parts()

    def change(self, values: Mapping[str, float]) -> Parts:
        """Do nothing: a controller has no parameters of the device."""
        return ()

    def publish(self) -> None:
        """Do nothing: its requests are recorded when they take effect."""

    def serve(self) -> None:
        """Do nothing: other subscriptions belong to the user's node."""

    def snapshot(self) -> bytes:
        """Return the complete state of the controller."""
        return self._controller.snapshot()

    def restore(self, snapshot: bytes) -> Parts:
        """Continue from a snapshot; earlier requests are part of the run's state."""
        self._controller.restore(snapshot)
        return self._parts()

    def _parts(self) -> Parts:
        return (self._requests.tobytes(),)
