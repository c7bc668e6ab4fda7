"""Interface of a peer: transmits one step to all workers, and one answer from each."""

from typing import Protocol


class PeerEnd(Protocol):
    """One end: the coordinator's, connected to all workers, or a worker's."""

    def send(self, message: bytes) -> None:
        """Send a step to every worker, or an answer to the coordinator."""
        ...

    def receive(self, timeout_s: float) -> bytes | None:
        """Return the next message, or None if none arrived within about ``timeout_s``."""
        ...

    def close(self) -> None:
        """Close the end; a second call does nothing."""
        ...
