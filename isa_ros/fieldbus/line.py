"""The interface of a bus that serves masters; each kind of bus has its own package or file."""

from collections.abc import Callable
from typing import Protocol, runtime_checkable


class Line(Protocol):
    """
    The slaves of a run on one bus, whose devices are `BusDevice` objects.

    The run gives the devices the samples of t_k, calls `update`, and then `serve` until the cycle
    begins that is tick k.
    """

    def serve(self, timeout: float) -> bool:
        """
        Answer the frames that arrive within ``timeout`` seconds; 0: those that are there.

        Return True as soon as a cycle has begun: a datagram that writes logical memory while the
        slaves are operational, or a SYNC. Frames behind it wait for the next call.
        """
        ...

    def update(self) -> None:
        """Take the devices' new samples as inputs; simulated time has advanced by one tick."""
        ...

    def miss(self) -> None:
        """Let the watchdog of every slave in operation expire: no process data for its time."""
        ...

    def close(self) -> None:
        """Leave the bus."""
        ...


class PortLine(Line, Protocol):
    """A line whose devices can lose their connection each."""

    def set_port(self, device: str, fault: str, is_on: bool) -> None:
        """Begin or end a fault of a device's connection; ``fault`` is a value of `BusPort`."""
        ...


@runtime_checkable
class ClockedLine(Protocol):
    """A line whose slaves have clocks that a master reads and steers by."""

    def keep_host_time(self, now_ns: Callable[[], int]) -> None:
        """Let the clocks run with host time, ns, instead of with ticks."""
        ...

    def until_sync(self) -> float:
        """Return the time in s until the clocks demand a tick; 0 if they do not say when."""
        ...
