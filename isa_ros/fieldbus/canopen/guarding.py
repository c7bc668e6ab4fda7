"""
Node guarding (CiA 301, 7.2.8.2.2): a master asks each node for its state by a remote frame.

An answer has a bit that alternates, from 0 after a reset. With a guard time and a life time factor
the node watches its master too, from the first request on: their product without one is a lost
bus. That time is simulated, as that of heartbeats, for it has an effect on the drive.
"""

_TOGGLE = 0x80
_NS_PER_MS = 1_000_000


class Guarding:
    """What a node answers to its master, and whether the master still asks."""

    def __init__(self) -> None:
        self._life_ns = 0
        self.reset()

    def reset(self) -> None:
        """Begin anew: the first answer has no bit, and nothing is watched."""
        self._toggle = self._silent_ns = 0
        self._is_watched = False

    def set_life_time(self, guard_ms: int, factor: int) -> None:
        """Set what is watched, 0 for nothing; it begins with the next request."""
        self._life_ns = guard_ms * factor * _NS_PER_MS
        self._is_watched = False

    @property
    def is_on(self) -> bool:
        """Return whether it has a life time."""
        return self._life_ns > 0

    def answer(self, state: int) -> bytes:
        """Return the answer of a node in this state to a request."""
        toggle, self._toggle = self._toggle, self._toggle ^ _TOGGLE
        self._silent_ns, self._is_watched = 0, self.is_on
        return bytes([state | toggle])

    def is_lost(self, step_ns: int) -> bool:
        """Let a tick pass; return whether the life time has run out, once."""
        if not self._is_watched:
            return False
        self._silent_ns += step_ns
        if self._silent_ns <= self._life_ns:
            return False
        self._is_watched = False
        return True
