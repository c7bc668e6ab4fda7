"""The kernels that most tests call, compiled by one process of all."""

from isa_ros.config.paths import CONFIG, shipped
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.kernel_directory import CACHE
from isa_ros.core.objects import Target
from isa_ros.export.exported import Exported
from isa_ros.export.library import kernels_of
from isa_ros.run.warm_up import warmed_up
from tests.locks import locked


def compile_kernels() -> None:
    """
    Load the kernels of all shipped configurations, or compile them while others wait.

    Others wait: two that compile at once would each compile all.
    """
    assert CACHE is not None, 'the tests need a directory for compiled kernels'
    with locked(CACHE):
        for path in shipped(CONFIG).values():
            warmed_up(load_run(path))


def make_exported(own: Exported, target: Target) -> None:
    """Make the object of an exported actuator, or wait for another process that does."""
    assert CACHE is not None, 'the tests need a directory for compiled kernels'
    with locked(CACHE):
        kernels_of(own, target)
