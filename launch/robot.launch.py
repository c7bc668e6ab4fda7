"""One run in lockstep, by default of the quadruped; the arguments are those of leg.launch.py."""

from isa_ros.nodes.run_launch import launched_run
from launch import LaunchDescription


def generate_launch_description() -> LaunchDescription:
    """Return the arguments and the nodes."""
    return launched_run(config='quadruped.yaml')
