"""Runs of the rigs of `isa faults`, without and with named faults."""

from functools import cache
from typing import Any

from isa_ros.analysis.faults.rigs import rig_of
from isa_ros.config.models.fault_catalogue import fault_catalogue

ATMOSPHERE, LPM, MPA = 101325.0, 1e-3 / 60.0, 1e6
BEGIN, LATER = 500, 740     # ticks of 1 ms: of the fault, and before the end of a run
SECONDS = 0.9


@cache
def run(rig: str, *faults: str, seconds: float = SECONDS, begin: float = 0.5) -> Any:
    """Return the result of a rig with named faults from a time on, 0.5 s."""
    own = rig_of(rig)
    return own.run.simulate(
        seconds, faults=[own.tree(fault_catalogue()[name], begin) for name in faults])


def pair(name: str, seconds: float = SECONDS) -> tuple[Any, Any]:
    """Return the results without and with a fault, in its rig."""
    rig = fault_catalogue()[name].rig
    return run(rig, seconds=seconds), run(rig, name, seconds=seconds)
