"""What a report shows over time, as data: groups of panels with their curves and captions."""

from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.analysis.signals.signals import Signal
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Curve(NamedTuple):
    """One line of a panel."""

    label: str
    signal: Signal
    """SI."""
    is_reference: bool = False
    """Drawn dashed."""


class Panel(NamedTuple):
    """One diagram over time; all of its curves have one unit."""

    title: str
    unit: str
    scale: float
    """SI units in one of ``unit``."""
    curves: Sequence[Curve]
    caption: str
    """What to see, in words."""

    @property
    def label(self) -> str:
        """Return title and unit."""
        return f'{self.title}, {self.unit}' if self.unit else self.title


class Group(NamedTuple):
    """The panels of one actuator, body or circuit."""

    name: str
    """Of its files: a name of a run, which may have a slash."""
    title: str
    panels: Sequence[Panel]
    sources: Sequence[str]
    """The actuators and supplies whose events are marked in it."""


def drawn(panels: Sequence[Panel]) -> list[Panel]:
    """Return panels without curves that were not recorded, and without empty ones."""
    kept = [panel._replace(curves=[own for own in panel.curves if len(own.signal.t)])
            for panel in panels]
    return [panel for panel in kept if panel.curves]


def columns(signal: Signal, labels: Sequence[str]) -> list[Curve]:
    """Return a curve for each column of a signal of several numbers."""
    return [Curve(label, Signal(signal.t, signal.values[:, k])) for k, label in enumerate(labels)]


def extent(values: Floats) -> tuple[float, float]:
    """Return least and greatest of the values that are numbers; NaN if none is."""
    known = values[~np.isnan(values)]
    return (float(known.min()), float(known.max())) if len(known) else (np.nan, np.nan)
