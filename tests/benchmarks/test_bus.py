"""Rows of the bus from measured cycles."""

from benchmarks.bus import frame_rows, real_time_rows
from benchmarks.bus_ring import Cycles
from isa_ros.bench.row import Aim
from isa_ros.fieldbus.real_time import Lateness
import pytest

FLOOR, LEG = Cycles(20_000.0, 40e-6, 80e-6), Cycles(2500.0, 400e-6, 1600e-6)


def test_a_plant_is_compared_with_real_time_and_with_slaves_without_one():
    """2500 cycles of 1 ms in a second; 40 us of the 400 us are the floor's."""
    rows = frame_rows('the leg', [FLOOR], [LEG], Aim(2000.0))
    speed, *parts = rows
    assert (speed.value, speed.ratio, speed.is_reached) == (2500.0, 2.5, True)
    assert [row.value for row in parts] == pytest.approx([40.0, 400.0, 80.0, 1600.0], rel=1e-9)
    assert [row.ratio for row in parts] == pytest.approx([1.0, 0.1, 1.0, 0.05], rel=1e-9)
    assert {row.part_of for row in parts} == {'the leg, frame pace'}


def test_a_missed_aim_says_what_a_cycle_takes():
    """Medians of the rounds."""
    slow = LEG._replace(per_s=1000.0)
    (speed, *_) = frame_rows('the leg', [FLOOR] * 3, [slow, LEG, slow], Aim(2000.0))
    assert (speed.value, speed.lowest, speed.highest) == (1000.0, 1000.0, 2500.0)
    assert speed.note.startswith('of a cycle of 1000 us: floor: round trip without a plant')


def test_a_ring_that_was_not_measured_says_why():
    (row,) = frame_rows(
        'the leg', [FLOOR], ['cycle 7: working counter -1, must be 9'], None)
    assert (row.value, row.note) == (None, 'cycle 7: working counter -1, must be 9')


def test_a_run_that_failed_is_mentioned():
    speed, *_ = frame_rows('the leg', [FLOOR, FLOOR], [LEG, 'no slaves on ecm'], None)
    assert (speed.value, speed.note) == (2500.0, '1 of 4 runs failed: no slaves on ecm')


def test_lateness_is_read_from_the_log_of_the_slaves():
    """As `Lateness` writes it at the end of a run."""
    times = Lateness(1e-3)
    for _ in range(50):
        times.add(30.5e-6)
    times.add(5e-3)
    log = ['isa: real-time pace without SCHED_FIFO: ticks may begin late', f'isa: {times}']
    speed, *parts = real_time_rows(LEG._replace(log=log))
    assert [row.value for row in parts[:4]] == [31.0, 5000.0, 5000.0, 1.0]
    assert 'without SCHED_FIFO' in speed.note
    (row,) = real_time_rows(LEG)
    assert row.note == 'the slaves have not reported their lateness'
