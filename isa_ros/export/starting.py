"""The start of an actuator as a kernel, bound to its memory."""

from typing import NamedTuple

from isa_ros.actuator.config import ConfiguredActuator
from isa_ros.actuator.rest import rest, RestRows
from isa_ros.actuator.rows import Memory
from isa_ros.config.runs.external_config import held_forces
from isa_ros.core.kernel import kernel
import numpy as np


def start_forces(config: ConfiguredActuator, configured: float) -> tuple[float, float]:
    """
    Return the forces, N | Nm, that an actuator may begin with: those that it holds.

    The ``configured`` one is among them: a run file may begin with relief valves open.
    """
    low, high = held_forces(config)
    return min(low, configured), max(high, configured)


class Started(NamedTuple):
    """Memory of `start_actuator`."""

    start: np.ndarray
    """`START`, (1,)."""
    gains: np.ndarray
    """Stiffness and damping of the impedance before the first setpoint, (2,)."""
    choices: np.ndarray
    """Its mode, and whether it is enabled once it is initialised, int64, (2,)."""
    memory: Memory
    """Of the actuator, its state zero."""


@kernel
def start_actuator(own):
    """Put the actuator at rest, as `isa_ros.actuator.rest.put_at_rest`; return 0."""
    memory, at = own.memory, own.start[0]
    rows = RestRows(
        memory.constants[0], memory.continuous[0], memory.ports[0], memory.thermals[0],
        memory.reu[0], memory.channels[0], memory.samples[0], memory.replies[0],
        memory.applied[0])
    rest(rows, (at.position, at.force, at.supply_pressure, at.return_pressure),
         (own.gains[0], own.gains[1]), own.choices[0], own.choices[1] != 0)
    memory.observed[0] = memory.samples[0]
    return 0
