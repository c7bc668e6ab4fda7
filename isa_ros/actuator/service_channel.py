"""
The service channel of a link: what is tuned in the REU travels in the frames too.

Gains, limits and levels of the REU are no process data: a master writes them by its mailbox, the
SDO of EtherCAT (CoE) and CANopen. Each frame has a part of that channel, and what it carries is
repeated until a frame has brought it; then the REU has it from the start of the next tick on. A
dead link brings nothing, and what no frame has brought for the watchdog's time is dropped. Faults,
the plant, the load and the link itself change at once: they are no commands.
"""

from collections.abc import Mapping
from itertools import compress

from isa_ros.actuator.frames import SLOTS
from isa_ros.actuator.tunable import GAINS, LOAD
from isa_ros.core.changeable import Changeable
from isa_ros.core.changing_values import ChangingValues
from isa_ros.core.saved_numbers import SavedNumbers
from isa_ros.core.timebase import PLANT_STEP_NS
import numpy as np

_AT_ONCE = ('plant.', 'link.', LOAD)


def travels(known: Mapping[str, Changeable]) -> np.ndarray:
    """Return whether each of `changing` is written by the channel, (n,)."""
    return np.array([
        not name.startswith(_AT_ONCE) and name not in GAINS and 'is_fault' not in own.declared
        for name, own in known.items()], bool)


def nothing(travels: np.ndarray) -> np.ndarray:
    """
    Return the rows of a channel with nothing on its way, (n, 1 + number that travel).

    A row has the plant step (-1: none) and the values; between two rows a frame is on its way that
    has left with the first, so that there are at most SLOTS + 1.
    """
    return np.full((SLOTS + 1, 1 + int(travels.sum())), -1.0)


class ServiceChannel(SavedNumbers):
    """
    What is on its way to the REU: the values as they were handed over at some plant steps.

    ``link`` is the `LINK` record, ``state`` its `LINK_STATE` and ``values`` all that may change,
    of which ``travels``, (n,), says what is written by the channel.
    """

    def __init__(
            self, link: np.record, state: np.record, values: ChangingValues,
            travels: np.ndarray) -> None:
        super().__init__(
            values.owner, ['plant step', *compress(values.names, travels)], nothing(travels))
        self._link, self._state, self._values, self._travels = link, state, values, travels

    def clear(self) -> None:
        """Begin a run with nothing on its way."""
        self._rows[:] = -1.0

    @property
    def _n(self) -> int:
        return int((self._rows[:, 0] >= 0.0).sum())

    def latch(self, step: int) -> bool:
        """Put in force what has been brought before plant step ``step``; return if any changed."""
        brought = self._brought()
        self._drop_stale(step, brought)
        n = self._n
        wanted = self._values.wanted[self._travels]
        newest = self._rows[n - 1, 1:] if n else brought
        if (wanted != newest).any():
            self._hand(step, wanted)
        in_force = self._values.wanted
        in_force[self._travels] = brought
        is_changed = self._values.latch(in_force)
        if self._n:
            self._values.is_settled = False
        return is_changed

    def _brought(self) -> np.ndarray:
        """Return the newest values that a frame has brought; forget those before."""
        values = self._values.now[self._travels]
        arrived = int((self._rows[:self._n, 0] < self._state.brought).sum())
        if arrived:
            values = self._rows[arrived - 1, 1:].copy()
            self._keep(self._rows[arrived:self._n])
        recorded = self._values.recorded[self._travels]
        found: np.ndarray = np.where(recorded, self._values.wanted[self._travels], values)
        return found

    def _keep(self, rows: np.ndarray) -> None:
        rows = rows.copy()
        self._rows[:] = -1.0
        self._rows[:len(rows)] = rows

    def _hand(self, step: int, values: np.ndarray) -> None:
        """Hand over values; they take the place of what no frame on its way has left with."""
        down, n = self._state.down, self._n
        sent = np.array([down.sent[(down.first + k) % SLOTS] for k in range(down.count)])
        ends = [*self._rows[1:n, 0], step]
        self._keep(np.vstack([
            *(row for row, end in zip(self._rows[:n], ends)
              if ((sent >= row[0]) & (sent < end)).any()), [step, *values]]))

    def _drop_stale(self, step: int, brought: np.ndarray) -> None:
        """Take back what no frame has brought for the watchdog's time."""
        n, longest = self._n, self._link.watchdog_ns
        if not longest or not n:
            return
        is_stale = (step - self._rows[:n, 0]) * PLANT_STEP_NS >= longest
        self._keep(self._rows[:n][~is_stale])
        if is_stale[-1]:
            self._values.withdraw(self._travels, brought)
