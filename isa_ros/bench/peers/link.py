"""What a peer has to carry: one step to all workers, one answer from each."""

from typing import Protocol


class Link(Protocol):
    """One end; the coordinator's reaches all workers, a worker's the coordinator."""

    def send(self, message: bytes) -> None:
        """Send a step to every worker, or an answer to the coordinator."""
        ...

    def receive(self, timeout_s: float) -> bytes | None:
        """Return the next message, or None where none arrived within about ``timeout_s``."""
        ...

    def close(self) -> None:
        """Let go; a second call does nothing."""
        ...
