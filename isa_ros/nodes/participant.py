"""The one way for a user's controller to join a lockstep run."""

from collections.abc import Callable

from isa_ros.controller import Controller
from isa_ros.nodes.lockstep.participant_end import ParticipantEnd
from isa_ros.nodes.lockstep.roles import ControllerRole
from isa_ros.processes.stopping import StopRequest
from rclpy.node import Node


class Participant:
    """
    Let ``controller`` of ``node`` take part in every run whose ``controllers`` name the node.

    The coordinator waits for it at every tick: it is given the state of tick k, and what it
    returns takes effect at tick k + 1, whatever the machine does meanwhile.
    """

    def __init__(self, node: Node, controller: Controller) -> None:
        self._end = ParticipantEnd(node, ControllerRole(controller))

    def spin(self, should_stop: Callable[[], bool] | None = None) -> None:
        """
        Take part in one run after the other until ``should_stop``, or a signal where None.

        What the controller raises is told to the coordinator, whose run ends with exit code
        3, and raised.
        """
        if should_stop is not None:
            self._end.spin(should_stop)
            return
        with StopRequest() as signalled:
            self._end.spin(signalled)
