"""Kernels that record quiet ticks into the buffers of a bag."""

from isa_ros.bag.message_chunk import Room
from isa_ros.run.packing import Names, Packer
import numpy as np
from tests.run.test_packing import HELD, some_rows


def test_a_recording_has_the_layout_room_and_stamps_that_were_asked_for():
    """One for each layout over a buffer; it is moved on, and not made anew."""
    packer = Packer(Names([('hip', True), ('knee', False)], [HELD]), some_rows())
    clock, buffer = np.array([5, 1_000_000]), np.zeros(9_000, np.uint8)
    layouts = packer.quiet_layout(1_000_000), packer.quiet_layout(1_000_000, b'\1\0')
    packer.start_ns = 3_000_000_000
    first, other = (packer.recording(clock, layout, Room(buffer, 100, 70, 3))
                    for layout in layouts)
    assert [own.memory.layout is layout for own, layout in zip((first, other), layouts)] == [
        True, True]
    assert first.memory.packing.times[2] == 3_000_000_000
    assert packer.recording(clock, layouts[0], Room(buffer, 240, 80, 1)) is first
    assert first.memory.place.tolist() == [240, 80] and other.memory.place.tolist() == [100, 70]
