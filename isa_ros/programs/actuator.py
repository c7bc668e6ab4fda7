"""The programs `actuator`, and one for each model; they end normally by a signal only."""

from collections.abc import Callable
import sys

from isa_ros.core.openblas import without_threads
from isa_ros.processes.ending import DONE, run_program


def main(model: str = '') -> int:
    """Run one actuator node; without ``model`` its parameter ``model`` names the model."""
    def loaded() -> Callable[[], int]:
        without_threads()
        from isa_ros.nodes.actuator.process import main as run
        return lambda: run(model=model)
    return run_program('actuator', loaded, interrupted=DONE)


def isa_v2() -> int:
    """Run one ISA v2."""
    return main('isa_v2')


def isa_v5() -> int:
    """Run one ISA v5."""
    return main('isa_v5')


def smart_manifold() -> int:
    """Run one smart manifold with its rotary actuator."""
    return main('smart_manifold')


if __name__ == '__main__':
    sys.exit(main())
