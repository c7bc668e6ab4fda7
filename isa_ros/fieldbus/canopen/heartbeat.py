"""
Heartbeats of a node: its own, in wall time, and those it watches, in simulated time.

A master watches nodes by its own clock, also while no tick passes; so a heartbeat is sent by wall
time, and it only has the NMT state. What a node watches has an effect on the drive, hence on the
bag, so its time counts ticks: a stalled master never trips it in frame pace.
"""

from collections.abc import Iterable

from isa_ros.fieldbus.device.can_identifiers import FIRST_NODE, LAST_NODE

_S_PER_MS = 1e-3
_NS_PER_MS = 1_000_000
_NODE_SHIFT, _TIME_MASK = 16, 0xFFFF


class HeartbeatProducer:
    """When the next heartbeat of a node is to be sent."""

    def __init__(self) -> None:
        self._period = 0.0
        self._next = 0.0

    def set_period(self, period_ms: int, now: float) -> None:
        """Set the period, 0 for none; the first one is sent at once."""
        self._period, self._next = period_ms * _S_PER_MS, now

    def wait(self, now: float) -> float | None:
        """Return the time (s) until the next one, None without any."""
        return max(0.0, self._next - now) if self._period else None

    def is_due(self, now: float) -> bool:
        """Return whether one is to be sent now; missed ones are left out."""
        if not self._period or now < self._next:
            return False
        following = self._next + self._period
        self._next = following if following > now else now + self._period
        return True


class HeartbeatConsumer:
    """The heartbeats of other nodes that a node watches, by its object 0x1016."""

    def __init__(self) -> None:
        self._limits: dict[int, int] = {}
        self._silent: dict[int, int] = {}

    def set_watched(self, values: Iterable[int]) -> None:
        """Set what is watched, each ``node << 16 | ms``; it begins with the first heartbeat."""
        self._limits = {
            value >> _NODE_SHIFT: (value & _TIME_MASK) * _NS_PER_MS for value in values
            if FIRST_NODE <= value >> _NODE_SHIFT <= LAST_NODE and value & _TIME_MASK}
        self._silent = {}

    def nodes(self) -> list[int]:
        """Return the nodes that are watched."""
        return list(self._limits)

    def take(self, node: int) -> None:
        """Take a heartbeat of a node."""
        self._silent[node] = 0

    def lost(self, step_ns: int) -> list[int]:
        """Let a tick pass; return the nodes whose heartbeat is now missed, once each."""
        late = []
        for node in list(self._silent):
            self._silent[node] += step_ns
            if self._silent[node] > self._limits[node]:
                del self._silent[node]
                late.append(node)
        return late
