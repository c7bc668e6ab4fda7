"""
What a page gets about thirty times a second: samples of all channels since the last frame.

The samples are float32, row by row, in base 64: a frame of 130 channels and 33 ticks takes 60 us
and 23 kB, as numbers in JSON 4 ms. Of more than `MOST` ticks every second, fourth, ... is there;
the run itself makes all of them.
"""

import base64
from collections.abc import Mapping
import json
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

PERIOD_S = 1.0 / 30.0
"""Host time between two frames."""
MOST = 256
"""Samples of a frame."""


class Samples(NamedTuple):
    """Samples of some ticks, evenly apart."""

    first: int
    """Tick of the first row."""
    every: int
    """Ticks from one row to the next."""
    values: NDArray[np.float32]
    """SI, NaN where there is none, (n, n_channels)."""


class Gathering:
    """Collects the samples of ``n_channels`` until the next frame, at most `MOST` of them."""

    def __init__(self, n_channels: int) -> None:
        self._rows = np.empty((MOST, n_channels), np.float32)
        self._first = self._next = self._n = 0
        self._every = 1

    def row(self, tick: int) -> NDArray[np.float32] | None:
        """
        Return the row to be filled with the sample of a tick; None: it is left out.

        If it is not the next tick, the samples before it are forgotten.
        """
        if tick != self._next:
            self.take()
        self._next = tick + 1
        if not self._n:
            self._first = tick
        if (tick - self._first) % self._every:
            return None
        if self._n == MOST:
            self._n = MOST // 2
            self._rows[:self._n] = self._rows[::2]
            self._every *= 2
        self._n += 1
        row: NDArray[np.float32] = self._rows[self._n - 1]
        return row

    def take(self) -> Samples:
        """Return the samples, and begin to collect anew; the next `row` overwrites them."""
        found = Samples(self._first, self._every, self._rows[:self._n])
        self._n, self._every = 0, 1
        return found


def frame_of(samples: Samples, **more: Any) -> bytes:
    """Return a frame as an event of a stream; ``more`` is what else the page is to know."""
    tree: Mapping[str, Any] = {
        'first': samples.first, 'every': samples.every, 'n': len(samples.values),
        'y': base64.b64encode(samples.values.astype('<f4', copy=False).tobytes()).decode(), **more}
    text = json.dumps(tree, separators=(',', ':'), allow_nan=False)
    return b'data: ' + text.encode() + b'\n\n'
