"""
Following error of a CiA 402 drive: 0x60F4, its window 0x6065 and how long it may last, 0x6066.

Time is counted in ticks: beyond the window for longer than 0x6066 is an error.
"""

from collections.abc import Mapping

from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.fieldbus.device.axis import COUNTS
from isa_ros.fieldbus.device.cia402_objects import NOT_WATCHED, TIMEOUT, WINDOW
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.objects import Value

_MS_NS = NS_PER_SECOND // 1000


class FollowingError:
    """Watches a deviation, m or rad, tick by tick."""

    def __init__(self, step_ns: int, values: Mapping[Key, Value]) -> None:
        self._step_ns, self._values = step_ns, values
        self._ticks = 0
        self.value = 0.0
        """The last deviation; in a fault that with which it began."""
        self.is_late = False
        """Whether it was beyond its window for too long."""

    def watch(self, deviation: float, is_watched: bool) -> None:
        """Take the deviation of a tick."""
        self.value = deviation
        window = int(self._values[WINDOW])
        if (not is_watched or window == NOT_WATCHED
                or abs(round(deviation * COUNTS)) <= window):
            self._ticks = 0
            return
        self._ticks += 1
        if self._ticks * self._step_ns > int(self._values[TIMEOUT]) * _MS_NS:
            self.is_late = True

    def forget(self) -> None:
        """Begin anew."""
        self._ticks, self.is_late = 0, False
