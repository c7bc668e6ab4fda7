"""The program `isa`."""

from collections.abc import Callable
import sys

from isa_ros.core.openblas import without_threads
from isa_ros.processes.ending import run_program

WITHOUT_RUN = frozenset({
    'bode', 'command', 'compare', 'echo', 'export', 'identify', 'paper', 'params', 'recover',
    'report', 'set', 'step', 'tune'})
"""Commands that record no run: nobody compares their last bits with those of another program."""


def main() -> int:
    """Run the command `isa` and return its exit code."""
    return run_program('isa', _loaded)


def _loaded() -> Callable[[], int]:
    if not WITHOUT_RUN.isdisjoint(sys.argv[1:2]):
        without_threads()
    from isa_ros.cli.main import main as run
    return run
