"""Kernels that record quiet ticks into the buffers of a bag."""

from isa_ros.bag.message_chunk import Room
from isa_ros.run.packing import Packer
from isa_ros.run.row_messages import Names
import numpy as np
import pytest
from tests.run.packed import HELD, some_rows


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


@pytest.mark.parametrize(('t_ms', 'step_ms', 'expected'), [
    (0, 1, 999), (995, 1, 4), (999, 1, 0), (1000, 1, 999), (300, 300, 2), (900, 300, 0)])
def test_ticks_are_quiet_until_one_reaches_a_full_second(t_ms, step_ms, expected):
    """That one has a temperature; without one no tick has."""
    def quiet_ticks(*heated: str) -> int:
        packer = Packer(Names([('hip', True), ('knee', False)], [HELD], heated=heated),
                        some_rows())
        return packer.quiet_ticks(t_ms * 1_000_000, step_ms * 1_000_000)
    assert quiet_ticks('knee') == expected
    assert quiet_ticks() > 100_000
