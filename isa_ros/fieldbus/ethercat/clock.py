"""
Distributed clocks, in simulated time or in that of the host.

All slaves share one local clock. In frame pace it advances by the interval of a tick when a tick
is over and stands still otherwise; in real time it is the host's, as it is when a frame arrives. A
frame reaches the slave at position k `HOP_NS` k later than the first, on its way back from the
last of n slaves 2 (n - 1 - k) `HOP_NS` later at port 1: a master that measures delays finds these.
System time is local time plus the offset that the master writes, so that its epoch is the
master's. The clocks do not drift: a time written to 0x0910 by the reference clock's datagram takes
effect at once and leaves no difference.
"""

from collections.abc import Callable

from isa_ros.fieldbus.ethercat.registers import (
    ACTIVATION_STATUS, RECEIVE_TIMES, SYNC0_CYCLE, SYNC_ACTIVATION, SYNC_START, SYSTEM_TIME,
    TIME_DELAY, TIME_OFFSET, UNIT_RECEIVE_TIME)

HOP_NS = 500
"""Assumed: a cable of a few metres and the way through two ports, ns."""
_WRAP = (1 << 64) - 1
_LOW, _LOW_SIZE = (1 << 32) - 1, 4
_CYCLIC, _SYNC0 = 1, 2
_PENDING_SYNC0, _START_IN_THE_PAST = 1, 4


class SharedClock:
    """Local time of all slaves of a line: ``now_ns``, the same for all that a frame reads."""

    def __init__(self, step_ns: int) -> None:
        self.step_ns = step_ns
        self.now_ns = 0
        self._host: Callable[[], int] | None = None

    def run_with(self, host_ns: Callable[[], int]) -> None:
        """Run with the time of the host, ns, from now on."""
        start = host_ns() - self.now_ns
        self._host = lambda: host_ns() - start

    def take(self) -> None:
        """Take the time at which a frame arrives."""
        if self._host is not None:
            self.now_ns = self._host()

    def advance(self) -> None:
        """Let one tick pass."""
        if self._host is None:
            self.now_ns += self.step_ns


class DistributedClock:
    """The clock of the slave at a position among ``n_slaves``."""

    def __init__(
            self, memory: bytearray, shared: SharedClock, position: int, n_slaves: int) -> None:
        self._memory, self._shared = memory, shared
        self._position, self._arrival_ns = position, position * HOP_NS
        self.end_at(n_slaves)
        self._offset_ns, self._delay_ns = self._arrival_ns, 0
        """From the shared clock to system time at the slave, with what the loop has corrected."""

    def end_at(self, n_slaves: int) -> None:
        """Let frames return from the last of so many slaves."""
        self._return_ns = self._arrival_ns + 2 * (n_slaves - 1 - self._position) * HOP_NS

    @property
    def system_ns(self) -> int:
        """Return the system time at which the present frame reaches the slave."""
        return self._shared.now_ns + self._offset_ns & _WRAP

    def refresh(self) -> None:
        """Write the system time into its register."""
        SYSTEM_TIME.put(self._memory, self.system_ns)

    def latch(self) -> None:
        """Store the receive times of the present frame."""
        local_ns = self._shared.now_ns + self._arrival_ns
        UNIT_RECEIVE_TIME.put(self._memory, local_ns)
        for port, time_ns in enumerate((local_ns, self._shared.now_ns + self._return_ns)):
            at = RECEIVE_TIMES.address + 4 * port
            self._memory[at:at + 4] = (time_ns & _LOW).to_bytes(4, 'little')

    def restart(self) -> None:
        """Take offset and delay, and forget what the control loop has corrected."""
        self._offset_ns = self._arrival_ns + TIME_OFFSET.value(self._memory)
        self._delay_ns = TIME_DELAY.value(self._memory)

    def follow(self, received: bytes) -> None:
        """Take the reference clock's time; its low 32 bits are enough."""
        if len(received) < _LOW_SIZE:
            return
        sent = int.from_bytes(received[:_LOW_SIZE], 'little') + self._delay_ns
        difference = sent - self._shared.now_ns - self._offset_ns & _LOW
        if difference:
            self._offset_ns += difference - (1 << 32) if difference >> 31 else difference

    def note_activation(self) -> None:
        """Show whether SYNC0 waits for its start, and whether that was in the past already."""
        activation = self._memory[SYNC_ACTIVATION.address]
        status = 0
        if activation & _CYCLIC and activation & _SYNC0:
            is_past = SYNC_START.value(self._memory) <= self.system_ns
            status = _PENDING_SYNC0 | (_START_IN_THE_PAST if is_past else 0)
        ACTIVATION_STATUS.put(self._memory, status)

    @property
    def until_sync_ns(self) -> int | None:
        """Return the time until SYNC0, ns; None if it is off."""
        activation = self._memory[SYNC_ACTIVATION.address]
        if not (activation & _CYCLIC and activation & _SYNC0):
            return None
        return (SYNC_START.value(self._memory) - self.system_ns) % self._shared.step_ns

    def is_cycle_right(self) -> bool:
        """Return whether SYNC0 is off, or comes once per tick."""
        if self.until_sync_ns is None:
            return True
        return SYNC0_CYCLE.value(self._memory) == self._shared.step_ns
