"""Packing and recording of a quiet tick, bound to its memory."""

from typing import NamedTuple

from isa_ros.bag.message_chunk import append
from isa_ros.bag.packed import Layout
from isa_ros.core.kernel import kernel
from isa_ros.run.pack_kernel import pack, Packing
import numpy as np


class QuietRecording(NamedTuple):
    """Memory of `record`."""

    clock: np.ndarray
    """Finished ticks, and the tick in ns, int64, (2,)."""
    packing: Packing
    block: np.ndarray
    """Bytes of the messages."""
    layout: Layout
    buffer: np.ndarray
    """Bytes of a chunk."""
    place: np.ndarray
    """Offset of the next tick in it, and bytes of a tick, int64, (2,)."""


@kernel
def record(own):
    """Pack the rows of a tick, and append their messages to a chunk; return 0."""
    tick, times, place = own.clock[0], own.packing.times, own.place
    times[0] = tick * own.clock[1]
    times[1] = times[0] - own.clock[1]
    pack(own.packing)
    append(own.buffer, place[0], own.block, own.layout, tick, times[2] + times[0])
    place[0] += place[1]
    return 0
