"""Rows of the bus from measured cycles."""

from benchmarks import bus_ring
from benchmarks.bus import frame_rows, real_time_rows
from benchmarks.bus_master import about_real_time
from benchmarks.bus_ring import Cycles, namespace, NEW_NAMESPACE
from isa_ros.bench.row import Aim
from isa_ros.fieldbus.real_time import Lateness, scheduled_first
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


@pytest.mark.parametrize('p99, is_reached', [(0.0004, True), (0.0006, False)])
def test_under_sched_fifo_a_tick_is_to_begin_within_half_a_millisecond(
        p99: float, is_reached: bool):
    """Without it there is no aim."""
    times = Lateness(1e-3)
    for lateness in (*[30.5e-6] * 90, *[p99] * 10):
        times.add(lateness)
    log = [f'isa: {times}']
    late = {row.name: row for row in real_time_rows(LEG._replace(log=log))}[
        'lateness of a tick, p99']
    assert (late.is_reached, bool(late.note)) == (is_reached, not is_reached)
    log.insert(0, 'isa: real-time pace without SCHED_FIFO: ticks may begin late')
    assert all(row.aim is None for row in real_time_rows(LEG._replace(log=log)))


def test_a_log_is_searched_for_what_the_slaves_say_of_real_time(monkeypatch):
    """Their scheduling at the begin, their lateness at the end; nothing else."""
    def refused(*_: object) -> None:
        raise PermissionError
    monkeypatch.setattr('os.sched_setscheduler', refused)
    lines: list[str] = []
    with scheduled_first(lines.append):
        pass
    lines += ['12 drives are enabled', str(Lateness(1e-3)), 'runs/leg']
    times = Lateness(1e-3)
    times.add(1e-5)
    assert about_real_time([*lines, str(times)]) == [lines[0], str(times)]


@pytest.mark.parametrize('user, code, has_users', [(0, 0, False), (0, 1, True), (1000, 0, True)])
def test_only_root_has_a_namespace_without_users_of_its_own(
        monkeypatch, user: int, code: int, has_users: bool):
    """Where that is allowed."""
    class Ended:
        returncode = code
    namespace.cache_clear()
    monkeypatch.setattr(bus_ring.os, 'geteuid', lambda: user)
    monkeypatch.setattr(bus_ring.subprocess, 'run', lambda *_, **__: Ended)
    found = namespace()
    namespace.cache_clear()
    assert found[0] == 'unshare' and '--net' in found
    assert ('--user' in found, found == NEW_NAMESPACE) == (has_users, has_users)
