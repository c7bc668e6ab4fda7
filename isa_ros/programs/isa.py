"""The program `isa`."""

from collections.abc import Callable

from isa_ros.processes.ending import run_program


def main() -> int:
    """Run the command `isa` and return its exit code."""
    return run_program('isa', _loaded)


def _loaded() -> Callable[[], int]:
    from isa_ros.cli.main import main as run
    return run
