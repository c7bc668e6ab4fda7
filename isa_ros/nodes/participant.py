"""Participation of a user's controller in lockstep runs."""

from collections.abc import Callable

from isa_ros.controller import Controller
from isa_ros.nodes.lockstep.participant_end import ParticipantEnd
from isa_ros.nodes.lockstep.roles import ControllerRole
from isa_ros.nodes.middleware.discovery import refuse_off
from isa_ros.processes.stopping import StopRequest
from rclpy.node import Node


class Participant:
    """
    Makes ``controller`` of ``node`` take part in every run whose ``controllers`` name the node.

    The coordinator waits for it at every tick: its input is the state of tick k, and its result
    takes effect at tick k + 1, independent of the speed of the machine.

    Raises
    ------
    ConfigError
        Discovery is switched off, so that no coordinator can find the node.

    """

    def __init__(self, node: Node, controller: Controller) -> None:
        refuse_off(node.get_name())
        self._end = ParticipantEnd(node, ControllerRole(controller))

    def spin(self, should_stop: Callable[[], bool] | None = None) -> None:
        """
        Take part in one run after another until ``should_stop``; None: until a signal.

        An exception of the controller, also of its `start`, is sent to the coordinator with the
        place where it was raised. The run then ends with this line and exit code 3, and this
        method raises it. A setpoint that is refused ends the run only.
        """
        if should_stop is not None:
            self._end.spin(should_stop)
            return
        with StopRequest() as signalled:
            self._end.spin(signalled)
