"""Quiet ticks for any recorder: kernels fill a buffer, from which it gets tick by tick."""

from collections.abc import Sequence

from isa_ros.bag.message_chunk import MESSAGE_HEADER, Room
from isa_ros.bag.packed import Layout, Packed
from isa_ros.run.recorders import QuietRecorder, Recorder
import numpy as np

BUFFER_BYTES = 256 * 1024
"""Of the records of a stretch; it has at least one tick."""
_SEQUENCE = 3   # place in a message's header


class Buffered:
    """A `QuietRecorder` that passes the ticks of a stretch on when it ends."""

    def __init__(self, recorder: Recorder) -> None:
        self._recorder = recorder
        self._buffer = np.empty(BUFFER_BYTES, np.uint8)
        self._layout: Layout | None = None
        self._t_ns = self._step_ns = self._tick_bytes = 0

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """Pass a tick on; as `Recorder`."""
        self._recorder.write_tick(t_ns, sequence, messages)

    def open_stretch(self, layout: Layout, t_ns: int, step_ns: int) -> Room:
        """Return room for ticks from ``t_ns`` on; as `QuietRecorder`."""
        self._layout, self._t_ns, self._step_ns = layout, t_ns, step_ns
        self._tick_bytes = int(np.sum(layout.sizes + MESSAGE_HEADER.size))
        if self._tick_bytes > len(self._buffer):
            self._buffer = np.empty(self._tick_bytes, np.uint8)
        return Room(self._buffer, 0, self._tick_bytes, len(self._buffer) // self._tick_bytes)

    def close_stretch(self, n_ticks: int) -> None:
        """Pass the first ticks on; raises as `Recorder.write_tick`."""
        layout = self._layout
        if layout is None:
            return
        ends = np.cumsum(layout.sizes + MESSAGE_HEADER.size)
        for k in range(n_ticks):
            at = k * self._tick_bytes
            sequence = MESSAGE_HEADER.unpack_from(self._buffer.data, at)[_SEQUENCE]
            self.write_tick(self._t_ns + k * self._step_ns, sequence, Packed(
                self._buffer, layout._replace(starts=at + ends - layout.sizes)))


def quiet(recorder: Recorder) -> QuietRecorder:
    """Return the recorder itself if it takes quiet ticks, else one that passes them on to it."""
    return recorder if isinstance(recorder, QuietRecorder) else Buffered(recorder)
