"""The coordinator as a program: actuators are started separately, or run in this process."""

from collections.abc import Sequence

from isa_ros.errors import one_line
from isa_ros.nodes.coordinator.node import CoordinatorNode, NAME
from isa_ros.nodes.coordinator.runs import coordinate, coordinate_locally
from isa_ros.nodes.middleware.arguments import init_ros
from isa_ros.nodes.middleware.domain import sole_coordinator
from isa_ros.nodes.middleware.environment import set_defaults
from isa_ros.processes.ending import ANSWER_IS_NO, DONE, end_of
from isa_ros.processes.stopping import StopRequest
from isa_ros.run.compiling import reported_compilation
from isa_ros.run.session import prepare
from isa_ros.run.terminal import terminal_report
from rclpy.utilities import try_shutdown

USAGE = (
    'the coordinator of a run: ros2 run isa_ros coordinator --ros-args -p config_file:=leg.yaml '
    '[-p scenario_file:=drop.yaml] [-p out:=DIR] [-p duration:=S] [-p in_process:=true]')


def main(args: Sequence[str] | None = None) -> int:
    """Coordinate the run that the parameters describe, and return the exit code."""
    with StopRequest() as should_stop:
        try:
            set_defaults()
            init_ros(args, USAGE)
            node = CoordinatorNode()
            try:
                session = prepare(node.request())
                for line in session.warnings:
                    node.get_logger().warning(one_line(line))
                start = coordinate_locally if session.request.in_process else coordinate
                with sole_coordinator(node.get_namespace()), reported_compilation(NAME):
                    try:
                        start(node, session, terminal_report(), should_stop)
                    finally:
                        for line in session.lines:
                            node.get_logger().warning(one_line(line))
                        for bag in session.bags:
                            print(bag, flush=True)
                if session.pace.shortfall:
                    node.get_logger().warning(session.pace.shortfall)
                if not session.is_as_wanted:
                    return ANSWER_IS_NO
            finally:
                node.destroy_node()
        except Exception as error:
            return end_of(NAME, error)
        finally:
            try_shutdown()
    return DONE
