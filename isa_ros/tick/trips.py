"""
What the devices of a run did by themselves: trips, and commands without effect.

A trip is found where the time of the last one in a `SAMPLE` changes. Behind a link that is when
the sample arrives; a trip that no sample has brought is not known.
"""

from collections.abc import Iterable, Iterator, Sequence
import sys
from typing import NamedTuple

from isa_ros.core.conditions import BITS, CONDITIONS, conditions
from isa_ros.core.device import state_name
from isa_ros.core.signals import Records
from isa_ros.core.units import of_coordinate, quantity
from isa_ros.text.table import digits
from isa_ros.tick.exchange import Rows, RowSink
import numpy as np
from numpy.typing import NDArray

_DIGITS = 4


class TripWarning(UserWarning):
    """A condition that tripped in a run, or commands of it without effect."""


class Trip(NamedTuple):
    """A condition that tripped."""

    actuator: str
    condition: str
    t_s: float
    """Time of the conversion at which it tripped."""
    value: float | None
    """Its quantity then, SI; None: not known, as of all but the last in a tick."""
    level: float | None
    """The level that it was beyond."""
    unit: str
    state: str
    """Of the device at the end of that tick."""

    @property
    def what(self) -> str:
        """Return the condition, with its quantity and level where they are known."""
        return f'{self.condition}{self._quantity}'

    @property
    def _quantity(self) -> str:
        if self.value is None or self.level is None:
            return ''
        condition = CONDITIONS[BITS[self.condition]]
        value, level = (quantity(digits(number, _DIGITS), self.unit)
                        for number in (self.value, self.level))
        return f', {condition.quantity} {value} {">" if condition.is_above else "<"} {level}'

    def __str__(self) -> str:
        return (f'{self.actuator}: {self.condition} tripped at t = {self.t_s:.6f} s'
                f'{self._quantity}: {self.state}')


class _Repeated:
    """The first trip of a condition of one actuator, and how often it came again."""

    def __init__(self, first: Trip) -> None:
        self.first, self.last, self.count = first, first, 1

    def add(self, trip: Trip) -> None:
        self.last = trip
        self.count += 1

    def __str__(self) -> str:
        again = f', {self.count} times until t = {self.last.t_s:.6f} s'
        return f'{self.first}{again if self.count > 1 else ""}'


class Tripped:
    """The conditions that tripped, each with its first trip and how often it came again."""

    def __init__(self) -> None:
        self._found: dict[tuple[str, str], _Repeated] = {}

    def __bool__(self) -> bool:
        return bool(self._found)

    def add(self, trips: Iterable[Trip]) -> None:
        """Add trips, in their order."""
        for trip in trips:
            key = trip.actuator, trip.condition
            if key in self._found:
                self._found[key].add(trip)
            else:
                self._found[key] = _Repeated(trip)

    def lines(self) -> list[str]:
        """Return a line for each condition of an actuator that tripped, in their order."""
        return [str(own) for own in self._found.values()]


def counts_of(names: Sequence[str], samples: Records) -> Iterator[str]:
    """Yield a line for each actuator with commands without effect, from its last `SAMPLE`."""
    for name, sample in zip(names, samples):
        unused, refused = int(sample['unused_setpoints']), int(sample['refused_requests'])
        if unused:
            yield f'{name}: {unused} setpoint{"s" * (unused > 1)} not followed: not enabled'
        if refused:
            yield (f'{name}: {refused} request{"s" * (refused > 1)} to enable, clear or stop '
                   'refused in its state')


class TripFinder:
    """Finds the trips in successive `SAMPLE` rows, (n,); ``actuators`` are (name, is_rotary)."""

    def __init__(self, actuators: Sequence[tuple[str, bool]]) -> None:
        self._actuators = actuators
        self._times = np.zeros(len(actuators))
        self._trips = np.zeros(len(actuators))

    def begin(self, samples: Records) -> None:
        """Take the first rows: what has tripped before is not new."""
        self._times[:], self._trips[:] = samples['trip_time'], samples['trips']

    def find(self, samples: Records) -> Iterator[Trip]:
        """Yield the trips since the last rows."""
        times = samples['trip_time']
        if (times == self._times).all():
            return
        for row in np.flatnonzero(times != self._times):
            yield from self._of(int(row), samples[row])
        self.begin(samples)

    def _of(self, row: int, sample: np.void) -> Iterator[Trip]:
        (name, is_rotary), t_s = self._actuators[row], float(sample['trip_time'])
        last, = conditions(float(sample['last_trip']))
        new = int(sample['trips']) & ~int(self._trips[row])
        for condition in (*(other for other in conditions(new) if other != last), last):
            is_last = condition == last and not np.isnan(sample['trip_value'])
            unit = CONDITIONS[BITS[condition]].unit
            yield Trip(
                name, condition, t_s, float(sample['trip_value']) if is_last else None,
                float(sample['trip_level']) if is_last else None,
                of_coordinate(unit, is_rotary), state_name(sample['device_state']))


class TripLog(RowSink):
    """Keeps what to print of the devices at the end of a run, over its resets."""

    def __init__(self, actuators: Sequence[tuple[str, bool]]) -> None:
        self._names = [name for name, _ in actuators]
        self._finder = TripFinder(actuators)
        self.tripped = Tripped()
        self._counts: list[str] = []
        self._rows: Rows | None = None

    def lines(self) -> list[str]:
        """Return a line for each condition that tripped, then those of commands without effect."""
        return [*self.tripped.lines(), *self._counts]

    def take(self, tick: int, rows: Rows) -> None:
        """Look for new trips; the first rows of a run begin."""
        if self._rows is None:
            self._rows = rows
            self._finder.begin(rows.samples)
            return
        self.tripped.add(self._finder.find(rows.samples))

    def quiet_ticks(self, tick: int) -> int:
        """Return as many as are asked for: no quiet tick has a trip."""
        return sys.maxsize

    def takes_applied(self, expected: NDArray[np.bool_]) -> bool:
        """Return True: commands are not looked at."""
        return True

    def end(self) -> None:
        """Keep the counts of the last rows."""
        if self._rows is not None:
            self._counts += counts_of(self._names, self._rows.samples)
            self._rows = None


def trips_of(samples: Records, actuators: Sequence[tuple[str, bool]]) -> list[Trip]:
    """Return the trips of a log, `SAMPLE` (n + 1, n_actuators), in their order."""
    finder = TripFinder(actuators)
    if not len(samples):
        return []
    finder.begin(samples[0])
    times = samples['trip_time']
    changed = np.flatnonzero((times[1:] != times[:-1]).any(axis=1)) + 1
    return [trip for tick in changed for trip in finder.find(samples[tick])]
