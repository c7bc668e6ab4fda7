"""
The slope of a command, made from its samples, or from its changes where it is held between them.

A command that is made at 50 Hz and logged at 1 kHz is held for 20 samples. Between neighbours its
slope is 0, and 20 times too large at each change; between one change and the next it is right.
"""

from typing import NamedTuple

from isa_ros.analysis.measured.csv_file import Floats
from isa_ros.analysis.signals.signals import Signal
from isa_ros.core.units import MILLI
from isa_ros.text.table import digits
import numpy as np
from numpy.typing import NDArray

Places = NDArray[np.intp]

_LONGEST_HOLD = 0.11    # s, of 10 Hz: what changes more rarely is a row of steps without slope
_LEAST_CHANGES = 10     # fewer do not show a rate
_OFTEN = 0.05           # of the times between two changes: so many may be shorter than a hold
_SHORT = 0.75           # of a hold


class Slope(NamedTuple):
    """The slope of a signal; ``n_held`` of its samples have one value, 1: it is not held."""

    signal: Signal
    n_held: int = 1
    hold: float = 0.0
    """The same in s."""

    def remark(self, name: str, of: str) -> str:
        """Return how a slope, ``name``, was made of what is held, ``of``; '' if it is not."""
        if self.n_held == 1:
            return ''
        return (f'{of} is held for {self.n_held} samples, {digits(self.hold / MILLI, 3)} ms: '
                f'{name} is its slope from change to change, held as long; map the commanded '
                f'velocity itself if it was logged')


def slope_of(own: Signal) -> Slope:
    """Return the slope of a signal of two samples or more, from one neighbour to the other."""
    changes = np.flatnonzero(np.diff(own.values)) + 1
    step = float(np.median(np.diff(own.t)))
    n_held = _held(changes)
    if n_held == 1 or n_held * step > _LONGEST_HOLD:
        return Slope(Signal(own.t, np.gradient(own.values, own.t)))
    at = _made(changes, n_held, len(own.t))
    t, values = _at(own, at, step), own.values[np.maximum(at, 0)]
    return Slope(Signal(np.maximum(t, own.t[0]), np.gradient(values, t)), n_held, n_held * step)


def _held(changes: Places) -> int:
    """
    Return for how many samples a value is held while it changes, by the first samples of values.

    It is a median, because pauses are few among the times between two changes. What often changes
    sooner is not held: it is rounded, and changes the sooner the faster it moves.
    """
    if len(changes) < _LEAST_CHANGES:
        return 1
    times = np.diff(changes)
    n_held = round(float(np.median(times)))
    return n_held if float(np.quantile(times, _OFTEN)) >= _SHORT * n_held else 1


def _made(changes: Places, n_held: int, n: int) -> Places:
    """
    Return the samples at which a held command was made: its changes, and as often in pauses.

    Those of a pause end one hold before the next change. The first is not after the first sample,
    and may be before it.
    """
    first = np.arange(changes[0], -n_held, -n_held)[::-1]
    later = [np.arange(change, min(before + 0.5 * n_held, change - 0.5), -n_held)[::-1]
             for before, change in zip(changes[:-1], changes[1:])]
    return np.concatenate([first, *later, np.arange(changes[-1] + n_held, n, n_held)]).astype(
        np.intp)


def _at(own: Signal, places: Places, step: float) -> Floats:
    """Return the times of samples; those before the first go on with its step."""
    times: Floats = own.t[np.maximum(places, 0)] + step * np.minimum(places, 0)
    return times
