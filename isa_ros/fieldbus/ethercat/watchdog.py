"""
The watchdog of process data.

It counts simulated time: cycles in which the outputs of this slave were not written although
those of others were. A master that is silent stops simulated time, and with it the watchdog; the
run calls `expire` where wall time counts.
"""

from isa_ros.fieldbus.ethercat.registers import (
    WATCHDOG_COUNTER, WATCHDOG_DIVIDER, WATCHDOG_STATUS, WATCHDOG_TIME)

_CLOCK_NS = 40
"""Period of the controller's clock of 25 MHz, ns."""
_DIVIDER_OFFSET = 2
_MOST = 0xFF
_STATUS = WATCHDOG_STATUS.address


class Watchdog:
    """Counts cycles without outputs."""

    def __init__(self, memory: bytearray, step_ns: int) -> None:
        self._memory, self._step_ns = memory, step_ns
        self._missed_ns = 0

    @property
    def time_ns(self) -> int:
        """Return after which time it expires, ns; 0: never."""
        divider = WATCHDOG_DIVIDER.value(self._memory) + _DIVIDER_OFFSET
        return divider * _CLOCK_NS * WATCHDOG_TIME.value(self._memory)

    def feed(self) -> None:
        """Note that the outputs were written."""
        self._missed_ns = 0
        self._memory[_STATUS] = 1

    def miss(self) -> bool:
        """Note a cycle without outputs; return whether the watchdog has expired with it."""
        self._missed_ns += self._step_ns
        return 0 < self.time_ns <= self._missed_ns and self.expire()

    def expire(self) -> bool:
        """Expire, unless it is off or has expired already; return whether it did now."""
        if not self.time_ns or not self._memory[_STATUS] & 1:
            return False
        at = WATCHDOG_COUNTER.address
        self._memory[at] = min(self._memory[at] + 1, _MOST)
        self._memory[_STATUS] = 0
        return True
