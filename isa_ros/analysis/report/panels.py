"""The diagrams of a report: curves are of signals that were recorded."""

from collections.abc import Sequence

from isa_ros.analysis.signals import diagrams
from isa_ros.analysis.signals.signals import Signal
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

Curve = diagrams.Curve[Signal]
Panel = diagrams.Panel[Signal]
Group = diagrams.Group[Signal]


def drawn(panels: Sequence[Panel]) -> list[Panel]:
    """Return panels without curves that were not recorded, and without empty ones."""
    return diagrams.kept(panels, lambda signal: len(signal.t) > 0)


def columns(signal: Signal, labels: Sequence[str]) -> list[Curve]:
    """Return a curve for each column of a signal of several numbers."""
    return [Curve(label, Signal(signal.t, signal.values[:, k])) for k, label in enumerate(labels)]


def extent(values: Floats) -> tuple[float, float]:
    """Return least and greatest of the values that are numbers; NaN if none is."""
    known = values[~np.isnan(values)]
    return (float(known.min()), float(known.max())) if len(known) else (np.nan, np.nan)
