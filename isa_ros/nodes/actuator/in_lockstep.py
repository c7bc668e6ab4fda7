"""An actuator's node that advances with the ticks of a coordinator."""

from collections.abc import Callable

from isa_ros.nodes.actuator.node import ActuatorNode
from isa_ros.nodes.lockstep.participant_end import ParticipantEnd
from isa_ros.nodes.lockstep.roles import ActuatorRole
from isa_ros.nodes.lockstep.steady_ticks import steady_ticks


def take_part(node: ActuatorNode, should_stop: Callable[[], bool]) -> None:
    """Take part in one run after another until ``should_stop``."""
    role = ActuatorRole(node)
    ParticipantEnd(node, role, node.setup.config.name, steady_ticks(node, role)).spin(should_stop)
