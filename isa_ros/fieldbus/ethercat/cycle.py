"""
Which frames belong to one cycle.

A process image that is too large for one frame, or that a master writes device by device, takes
several frames. They are one cycle, hence one tick. It is complete when all outputs that are mapped
have been written and all inputs read. If frames are lost it never is: then the frame that writes
the first address of a cycle again, or any address that was written in this cycle, begins the next
one.
"""

from collections.abc import Sequence

Range = tuple[int, int]
"""First logical address of a datagram that writes, and the one behind its last."""


class Cycle:
    """What has been written in the present cycle."""

    def __init__(self) -> None:
        self._written: list[Range] = []
        self._first: int | None = None

    @property
    def is_open(self) -> bool:
        """Return whether anything has been written."""
        return bool(self._written)

    def is_over(self, writes: Sequence[Range]) -> bool:
        """Return whether a frame with these writes belongs to the next cycle."""
        return any(start == self._first or any(
            start < behind and end > begin for begin, behind in self._written)
            for start, end in writes) if self._written else False

    def add(self, writes: Sequence[Range]) -> None:
        """Note the writes of a frame of this cycle."""
        if self._first is None and writes:
            self._first = writes[0][0]
        self._written += writes

    def end(self) -> None:
        """Begin the next cycle."""
        self._written.clear()

    def forget(self) -> None:
        """Forget how cycles begin: the logical memory is mapped anew."""
        self._written.clear()
        self._first = None
