"""The program `coordinator`."""

from collections.abc import Callable
import sys

from isa_ros.processes.ending import run_program


def main() -> int:
    """Coordinate the run that the ROS parameters describe, and return the exit code."""
    return run_program('coordinator', _loaded)


def _loaded() -> Callable[[], int]:
    from isa_ros.nodes.coordinator.process import main as run
    return run


if __name__ == '__main__':
    sys.exit(main())
