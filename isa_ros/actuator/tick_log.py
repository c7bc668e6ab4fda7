"""Many ticks of the actuators of one process in one call, with a row of each."""

from typing import NamedTuple

from isa_ros.actuator.integration import COPIES
from isa_ros.actuator.rows import Memory
from isa_ros.actuator.states import STATES, write_states
from isa_ros.actuator.ticking import Ticked
from isa_ros.core.bound import Bound, Program
from isa_ros.core.kernel import part_of_kernel
from isa_ros.core.signals import Records, SAMPLE
import numpy as np


class TickLog(NamedTuple):
    """The actuators before the first of n ticks and at the end of each, (n + 1, n_actuators)."""

    samples: Records
    """`SAMPLE`."""
    states: Records
    """`STATES`."""


class Logging(NamedTuple):
    """Memory of what goes before and after each tick of a log."""

    row: np.ndarray
    """Row of the log to be written next, (1,): the tick that ends with it is that before."""
    given: np.ndarray
    """`COMMAND` of all ticks, (n_ticks, n)."""
    commands: np.ndarray
    """`COMMAND` that the tick takes, (n,)."""
    samples: np.ndarray
    """`SAMPLE`, (n_ticks + 1, n), or of no row."""
    states: np.ndarray
    """`STATES`, (n_ticks + 1, n)."""
    memory: Memory
    """Of the actuators."""


@part_of_kernel
def give_commands(own):
    """Hand the commands of its row to the next tick; ``own`` is a `Logging`."""
    for n in range(len(own.commands)):
        own.commands[n] = own.given[own.row[0] - 1, n]
    return 0


@part_of_kernel
def write_row(own):
    """Write `SAMPLE`, if they have rows, and `STATES` of all into the next row of the log."""
    row, memory = own.row[0], own.memory
    for n in range(own.states.shape[1]):
        if row < len(own.samples):
            own.samples[row, n] = memory.samples[n]
        write_states(memory.continuous[n * COPIES], memory.replies[n].force, memory.constants[n],
                     memory.reu[n], own.states[row, n])
    own.row[0] = row + 1
    return 0


class LoggedTicks:
    """
    The ticks of actuators with a row of ``given`` for each, `COMMAND` (n_ticks, n).

    ``tick`` is bound to ``own``. The first row of ``log`` is the state before them.
    """

    def __init__(
            self, tick: Bound, own: Ticked, given: Records, *, with_samples: bool = True) -> None:
        n_ticks, n = given.shape
        self.log = TickLog(np.empty((n_ticks + 1 if with_samples else 0, n), SAMPLE),
                           np.empty((n_ticks + 1, n), STATES))
        memory = Logging(np.zeros(1, np.int64), np.ascontiguousarray(given), own.commands,
                         self.log.samples, self.log.states, own.memory)
        write = Bound(write_row, memory)
        write.run()
        self._program = Program((Bound(give_commands, memory), tick, write))

    def run(self, n_ticks: int) -> tuple[int, int]:
        """Run the next ticks; return how many were begun, and what the last one returned."""
        done, place, found = self._program.run(n_ticks)
        return (done, 0) if place < 0 else (done + 1, found)
