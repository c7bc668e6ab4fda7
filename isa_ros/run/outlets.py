"""Where the messages of a run go that somebody has subscribed to."""

from collections.abc import Collection, Sequence
from typing import NamedTuple, Protocol

from isa_ros.core.topic import KEPT
from isa_ros.run.packing import Messages


class Outlet(Protocol):
    """The publishers of one source, in the order of its topics."""

    wanted: Collection[int] | None
    """Places of the messages that `publish` looks at; None: all."""

    def refresh(self) -> None:
        """Look for subscriptions now."""
        ...

    def skip(self, n_ticks: int) -> None:
        """Pass so many ticks without a message."""
        ...

    def has_subscribers(self) -> bool:
        """Return whether there is a subscription; called once a tick."""
        ...

    def publish(self, messages: Messages) -> None:
        """Publish to the topics with subscriptions, and messages that are kept for later ones."""
        ...


class NoOutlet:
    """An `Outlet` without topics."""

    wanted: Collection[int] | None = ()

    def refresh(self) -> None:
        """Do nothing."""

    def skip(self, n_ticks: int) -> None:
        """Do nothing."""

    def has_subscribers(self) -> bool:
        """Return False."""
        return False

    def publish(self, messages: Messages) -> None:
        """Do nothing."""


def first_published(outlet: Outlet, n: int) -> int:
    """
    Return from which of ``n`` messages on a topic that is kept gets them, after a look.

    Without a subscription those that a later one receives are enough.
    """
    outlet.refresh()
    return 0 if outlet.has_subscribers() else max(0, n - KEPT.depth)


class Outlets(NamedTuple):
    """The publishers of a run."""

    clock: Outlet = NoOutlet()
    events: Outlet = NoOutlet()
    surroundings: Outlet = NoOutlet()
    actuators: Sequence[Outlet] = ()
    """One per actuator, in their order; empty if the actuators' own nodes publish."""
