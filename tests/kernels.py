"""The kernels that most tests call, compiled by one process of all."""

from pathlib import Path

from isa_ros.config.paths import CONFIG, shipped
from isa_ros.config.run_file import load_run
from isa_ros.run.warm_up import warmed_up
import numba
from tests.locks import locked


def compile_kernels() -> None:
    """
    Load the kernels of all shipped configurations, or compile them while others wait.

    From an empty cache one core needs about 20 s, and as many cores as try need 20 s each.
    """
    cache = Path(numba.config.CACHE_DIR)
    cache.mkdir(parents=True, exist_ok=True)
    with locked(cache):
        for path in shipped(CONFIG).values():
            warmed_up(load_run(path))
