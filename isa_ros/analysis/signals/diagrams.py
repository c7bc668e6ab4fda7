"""
What a page shows over time, as data: groups of panels with their curves.

A curve is of anything that has samples: of a `Signal` in a report, of the name of a channel in a
page that gets its samples later.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Generic, TypeVar

from isa_ros.core.frozen import frozen

S = TypeVar('S')


@frozen
class Curve(Generic[S]):
    """One line of a panel."""

    label: str
    signal: S
    """SI."""
    is_reference: bool = False
    """Drawn dashed."""


@frozen
class Panel(Generic[S]):
    """One diagram over time; all of its curves have one unit."""

    title: str
    unit: str
    scale: float
    """SI units in one of ``unit``."""
    curves: Sequence[Curve[S]]
    caption: str = ''
    """What to see, in words."""

    @property
    def label(self) -> str:
        """Return title and unit."""
        return f'{self.title}, {self.unit}' if self.unit else self.title


@frozen
class Group(Generic[S]):
    """The panels of one actuator, body or circuit."""

    name: str
    """Of its files: a name of a run, which may have a slash."""
    title: str
    panels: Sequence[Panel[S]]
    sources: Sequence[str] = ()
    """The actuators and supplies whose events are marked in it."""


def kept(panels: Sequence[Panel[S]], is_there: Callable[[S], bool]) -> list[Panel[S]]:
    """Return panels with the curves whose signal is there, without those that have none."""
    found = [replace(panel, curves=[own for own in panel.curves if is_there(own.signal)])
             for panel in panels]
    return [panel for panel in found if panel.curves]
