"""
Signals as the bytes of a page: about 0.7 bytes a sample, read back by `browser/signals.js`.

A signal is quantised to 16 bits between its least and greatest value, so that it is exact to half
a step of 1/65533 of its range; a gap is the greatest number. Second differences modulo 2^16, with
their sign in the lowest bit, have few different values; low bytes, then high bytes, are deflated.
"""

import base64
from typing import Any, NamedTuple
import zlib

from isa_ros.analysis.report.panels import extent, Floats
from isa_ros.analysis.report.thinning import SignalThinning
from isa_ros.analysis.signals.signals import Signal
import numpy as np
from numpy.typing import NDArray

LEVELS = 65_533     # steps of the range; two numbers are left, of which the greatest is a gap
GAP = 65_535
_MODULUS = 65_536
_EVEN = 1e-6        # of a step, of times that are evenly spaced
_LEVEL = 6          # of zlib


class EncodedSignal(NamedTuple):
    """Where a signal lies in the bytes of a page, and its range, SI."""

    offset: int
    grid: int
    """Index of its times."""
    low: float
    high: float


class Encoder:
    """
    Collects signals; each is stored once, however often it is drawn.

    ``thinning`` chooses the samples of signals that are too many for a page.
    """

    def __init__(self, thinning: SignalThinning | None = None) -> None:
        self._thinning = thinning
        self.grids: list[dict[str, Any]] = []
        """Times of signals: t0, step and n, all s; and offset where they are not even."""
        self._known: dict[tuple[int, ...], EncodedSignal] = {}
        self._grid_of: dict[int, int] = {}
        self._kept: list[Any] = []      # so that no identity is used again
        self._deflate = zlib.compressobj(_LEVEL)
        self._pieces: list[bytes] = []
        self._offset = 0

    def add(self, signal: Signal) -> EncodedSignal:
        """Store a signal, its times (n,) and values (n,)."""
        place = signal.values.__array_interface__['data'][0]
        key = place, len(signal.values), *signal.values.strides, id(signal.t)
        if key not in self._known:
            self._kept.append(signal)
            if self._thinning is not None:
                signal = self._thinning.thinned(signal)
                self._kept.append(signal)
            low, high = extent(signal.values)
            if np.isnan(low):
                low = high = 0.0
            grid, offset = self._grid(signal.t), self._offset
            self._store(_differences(quantised(signal.values, low, high)))
            self._known[key] = EncodedSignal(offset, grid, low, high)
        return self._known[key]

    def text(self) -> str:
        """Return all that was stored, deflated, in base 64; nothing can be added afterwards."""
        self._pieces.append(self._deflate.flush())
        return base64.b64encode(b''.join(self._pieces)).decode()

    def _grid(self, t: Floats) -> int:
        """Return the index of the times of a signal, s, (n,)."""
        if id(t) not in self._grid_of:
            step = float(t[-1] - t[0]) / (len(t) - 1) if len(t) > 1 else 1.0
            grid: dict[str, Any] = {'t0': float(t[0]), 'step': step, 'n': len(t)}
            if np.abs(t - t[0] - step * np.arange(len(t))).max() > _EVEN * step:
                low, high = float(t[0]), float(t[-1])
                fine = np.round((t - low) * (2.0 ** 32 - 1.0) / (high - low)).astype(np.uint32)
                grid |= {'offset': self._offset, 'high': high}
                self._store(np.diff(fine, prepend=fine[:1]).astype('<u4'))
            self._grid_of[id(t)] = len(self.grids)
            self.grids.append(grid)
        return self._grid_of[id(t)]

    def _store(self, numbers: NDArray[Any]) -> None:
        """Deflate numbers, all low bytes first."""
        split = numbers.view(np.uint8).reshape(len(numbers), -1).T
        data = np.ascontiguousarray(split).tobytes()
        self._pieces.append(self._deflate.compress(data))
        self._offset += len(data)


def quantised(values: Floats, low: float, high: float) -> NDArray[np.int64]:
    """Return values as numbers of 0 to `LEVELS` from ``low`` to ``high``; NaN is `GAP`, (n,)."""
    if high == low:
        levels = np.zeros(len(values))
    else:
        half = 0.5 * high - 0.5 * low   # the range of finite values need not be finite
        levels = np.round((0.5 * values - 0.5 * low) / half * LEVELS)
    return np.where(np.isnan(values), GAP, np.nan_to_num(levels)).astype(np.int64)


def _differences(levels: NDArray[np.int64]) -> NDArray[np.uint16]:
    """Return second differences modulo 2^16, the sign in the lowest bit, little endian, (n,)."""
    second = np.diff(levels, n=2, prepend=[0, 0])
    signed = (second + _MODULUS // 2) % _MODULUS - _MODULUS // 2
    return ((signed << 1 ^ signed >> 63) & GAP).astype('<u2')
