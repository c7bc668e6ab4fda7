"""
Ticks of an actuator's node that need nothing of Python, in a compiled loop.

They come at the board of the run, or by socket.

Setpoints, requests and subscriptions are looked at before and after every tick while the node has
a matched publisher of setpoints or a subscription; without any, before a tick once per `QUIET_NS`
of host time. Applied setpoints, which the middleware keeps
for later subscriptions, are handed to it every `KEPT_NS` and before all that Python handles; once
a subscription is there, without a gap and at every tick.
"""

from collections.abc import Sequence
import time

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.core.kernel import IS_COMPILED
from isa_ros.nodes.actuator.node import ActuatorNode
from isa_ros.nodes.lockstep.roles import ActuatorRole
from isa_ros.nodes.lockstep.sockets import is_possible, LARGEST, LocalWire
from isa_ros.run.wire.answer_loop import AnswerLoop, MOST_KEPT
from isa_ros.run.wire.answering import Ended
from isa_ros.run.wire.parts import Parts
from isa_ros.run.wire.steps import Step
import numpy as np

QUIET_NS = 20_000_000
"""Host time between two looks at what may have arrived, without a matched publisher."""

MOST = 1000
"""Ticks of a call; the fastest take longer than `QUIET_NS`."""

KEPT_NS = 100_000_000
"""Host time between two times at which applied setpoints are published, without a subscription."""


class SteadyTicks:
    """The loop of a ``node``, whose actuator has this role."""

    def __init__(self, node: ActuatorNode, role: ActuatorRole) -> None:
        self._node, self._role = node, role
        self._loop = _loop_of(node.actuator)
        self._keeps = not node.actuator.has_link
        self._is_due = False
        self._due_ns = self._kept_due_ns = 0
        self._wire: LocalWire | None = None

    def expect(self, step: Step, index: int) -> None:
        """Take steps like this one from now on, a tick that was checked and executed."""
        self._loop.expect(step, index, self._role.has_feed)

    def wait(self, wire: LocalWire) -> bytes | None:
        """Return the next message, of either; None: none has come for a while."""
        self._loop_at(wire).run(wire.number, 0, 0, 1, keeps=False)  # each step is due
        return self._loop.take_step() if self._loop.has_step else wire.take()

    def forget(self) -> None:
        """Take no step until one is executed by Python."""
        self._loop.forget()

    @property
    def are_next(self) -> bool:
        """Return whether the next tick may be one of the loop."""
        return self._loop.is_expecting and self._role.is_settled

    def run(self, wire: LocalWire, tick: int) -> Ended:
        """Answer ticks from ``tick`` on; before a tick, do what is due."""
        if not self._is_due:
            ended = self._run(wire, tick, self._due_ns, MOST)
            if ended is not Ended.DUE or self._loop.done:
                return ended
        self._is_due = False
        self._role.serve()
        if not self._role.is_settled:
            return self._loop.leave()
        is_watched, due_ns = self._node.is_watched(), time.monotonic_ns() + QUIET_NS
        self._due_ns = 0 if is_watched else due_ns
        return self._run(wire, tick, due_ns, 1 if is_watched else MOST)

    def _run(self, wire: LocalWire, tick: int, due_ns: int, most: int) -> Ended:
        ended = self._loop_at(wire).run(wire.number, tick, due_ns, most, self._keeps)
        self._is_due = ended is Ended.DUE
        return ended

    def _loop_at(self, wire: LocalWire) -> AnswerLoop:
        """Return the loop, which waits at the board that a wire has brought or at its socket."""
        if wire is not self._wire:
            self._wire, wire.ring = wire, self._loop.ring
            self._loop.stand_at(wire.board, self._role.index)
        return self._loop

    def end(self) -> None:
        """Move the actuator's time on by the ticks of `run`."""
        self._node.actuator.end_ticks(self._loop.done, 0)

    def parts(self) -> Parts:
        """
        Return the parts of the answer to the last tick.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.

        """
        self._node.actuator.end_ticks(0, self._loop.broken)
        return self._role.parts()

    def publish(self) -> None:
        """Publish the results of the last tick where there is a subscription, and what is due."""
        node, loop = self._node, self._loop
        if node.has_news(loop.done, self._keeps):
            t_ns = node.actuator.t_ns
            self._publish([own for own in loop.take_kept() if own[0] != t_ns])
            node.publish_last()
        elif loop.n_kept == MOST_KEPT or time.monotonic_ns() >= self._kept_due_ns:
            self.publish_kept()

    def publish_kept(self) -> None:
        """Publish the setpoints that were applied and are not published yet."""
        self._publish(self._loop.take_kept())

    def _publish(self, commands: Sequence[tuple[int, np.void]]) -> None:
        if commands:
            self._kept_due_ns = time.monotonic_ns() + KEPT_NS
            self._node.publish_commands(commands)

    @property
    def done(self) -> int:
        """Return the number of ticks of the last `run`."""
        return self._loop.done

    @property
    def has_step(self) -> bool:
        """Return whether the loop has received a message that is not handled."""
        return self._loop.has_step

    def take_step(self) -> bytes:
        """Return the message that the loop has left."""
        return self._loop.take_step()


def _are_possible() -> bool:
    return IS_COMPILED and is_possible()


def _loop_of(actuator: SmartActuator) -> AnswerLoop:
    return AnswerLoop(actuator.ticked, actuator.advance, LARGEST)


def warm_up_ticks(actuator: SmartActuator) -> None:
    """Compile the loop, or load it from the cache."""
    if _are_possible():
        _loop_of(actuator)


def steady_ticks(node: ActuatorNode, role: ActuatorRole) -> SteadyTicks | None:
    """Return the loop of a node; None where there are neither sockets nor a compiler."""
    return SteadyTicks(node, role) if _are_possible() else None
