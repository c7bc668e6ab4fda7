"""One run in lockstep, by default of the leg; `isa_ros.nodes.run_launch` has its arguments."""

from isa_ros.nodes.run_launch import launched_run
from launch import LaunchDescription


def generate_launch_description() -> LaunchDescription:
    """Return the arguments and the nodes."""
    return launched_run()
