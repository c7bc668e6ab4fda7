"""The tick of the actuators of one process, bound to their memory."""

from typing import NamedTuple

from isa_ros.actuator.kernel import actuator_tick
from isa_ros.actuator.rows import Memory, memory_of
from isa_ros.core.bound import Bound
from isa_ros.core.kernel import entry_of, KernelEntry, part_of_kernel
from isa_ros.core.kinds import kind_of
from isa_ros.core.signals import COMMAND, LOAD_PORT
import numpy as np


class Ticked(NamedTuple):
    """Memory of the tick of ``n`` actuators."""

    clock: np.ndarray
    """Plant step at which the next tick begins, and plant steps of a tick, int64, (2,)."""
    ports: np.ndarray
    """`LOAD_PORT` of the tick, (n,)."""
    commands: np.ndarray
    """`COMMAND` that takes effect at its start, (n,)."""
    memory: Memory
    """Of the actuators."""


@part_of_kernel
def group_tick(own):
    """
    Advance all by one tick and move the clock on; ``own`` is a `Ticked`.

    Return 1 + the place of the first state that is no longer finite in the states of all, or 0.
    """
    first, steps = own.clock[0], own.clock[1]
    own.clock[0] = first + steps
    return 1 + actuator_tick(first, steps, own.ports, own.commands, own.memory)


def ticked(memory: Memory, steps: int) -> Ticked:
    """Return the memory of the tick of actuators, ``steps`` plant steps long, at t = 0."""
    n = len(memory.ports)
    return Ticked(np.array([0, steps], np.int64), np.zeros(n, LOAD_PORT), np.zeros(n, COMMAND),
                  memory)


def bound_tick(own: Ticked) -> Bound:
    """Return the tick over its memory."""
    return Bound(group_tick, own)


def tick_kernel() -> KernelEntry:
    """Return the tick as it is compiled and kept."""
    return entry_of(group_tick, kind_of(ticked(memory_of(1), 1)))
