"""Motions that the drive makes by itself: profiles and halt."""

import pytest

from .master_402 import (
    CSP, CSV, ENABLE, enabled, POSITION, RESET, SHUTDOWN, state, SWITCH_ON)
from .rig import Master

PP, PV = 1, 3
NEW, AT_ONCE, RELATIVE, HALT = 1 << 4, 1 << 5, 1 << 6, 1 << 8
REACHED, ACKNOWLEDGED = 1 << 10, 1 << 12
LIMITED = 1 << 11
UM = 1e-6


def profiled(rig, mode=PP, speed=100_000, acceleration=2_000_000, deceleration=1_000_000):
    """Return a master whose drive is enabled in a mode with a profile, in um and s."""
    master = enabled(rig, mode)
    for index, value in ((0x6081, speed), (0x6083, acceleration), (0x6084, deceleration)):
        master.download(index, 0, value)
    return master


def demands(master, control, ticks):
    """Return demanded positions, um, of some ticks."""
    found = []
    for _ in range(ticks):
        master.cycle(control)
        found.append(master.upload(0x6062))
    return found


def moves(master, target, bits=0, most=2000):
    """Send a target, and return the demands until it is reached."""
    master.outputs[0x607A, 0] = target
    found = [master.upload(0x6062)]
    word = master.cycle(ENABLE | NEW | bits)
    assert word & ACKNOWLEDGED
    while not word & REACHED and len(found) < most:
        found.append(master.upload(0x6062))
        word = master.cycle(ENABLE)
    return [*found, master.upload(0x6062)]


@pytest.mark.parametrize('way', [30_000, -15_000, 2000, 7])
def test_a_profile_keeps_speed_and_accelerations_and_ends_at_its_target(rig, way):
    """A trapezoid, or a triangle on a short way; the differences are rounded to um a tick."""
    master = profiled(rig)
    start = master.upload(0x6062)
    way *= 1 if start + way in range(100_001) else -1
    found = moves(master, start + way)
    speeds = [(b - a) * 1000 for a, b in zip(found, found[1:])]
    assert found[-1] == start + way == master.upload(0x607A)
    assert all(0 <= one * way for one in speeds)
    assert max(map(abs, speeds)) <= 100_000 + 1000      # 1 um in a tick of 1 ms
    changes = [abs(b) - abs(a) for a, b in zip(speeds, speeds[1:])]
    assert max(changes) <= 2000 + 2000 and min(changes) >= -1000 - 2000
    if abs(way) > 20_000:
        # v / 2a + v / 2d + s / v: 25 ms + 50 ms + 300 ms, within 5 ticks.
        assert max(map(abs, speeds)) == pytest.approx(100_000, abs=1000)
        assert len(found) == pytest.approx(abs(way) / 100 + 75, abs=5)


def test_the_load_is_borne_from_the_first_tick_on(rig):
    """The force measured at the begin: without it 490 N of 1e5 N/m let it sink by 4.9 mm."""
    rig.simulation.tune('ram', {'load.force': -490.0})
    for _ in range(400):
        rig.simulation.step()
    rig.device.take_sample(rig.sample, rig.simulation.ticks)
    master = enabled(rig, PP)
    start = master.inputs[POSITION]
    master.cycle(ENABLE | NEW, x607A=start)
    for _ in range(300):
        master.cycle(ENABLE)
    assert abs(master.inputs[POSITION] - start) < 200   # a count of the load cell: 20 um


def test_a_target_by_the_way_waits_for_the_one_before(rig):
    master = profiled(rig)
    start = master.upload(0x6062)
    side = 1 if start < 50_000 else -1
    master.outputs[0x607A, 0] = start + side * 5000
    master.cycle(ENABLE | NEW)
    master.cycle(ENABLE)
    master.outputs[0x607A, 0] = start + side * 1000
    assert master.cycle(ENABLE | NEW) & ACKNOWLEDGED
    master.outputs[0x607A, 0] = start + side * 9000
    assert master.cycle(ENABLE) & ACKNOWLEDGED      # no room for a third
    master.cycle(ENABLE | NEW)
    found = demands(master, ENABLE, 400)
    assert max(side * (one - start) for one in found) == 5000
    assert found[-1] == start + side * 1000
    assert not master.cycle(ENABLE) & ACKNOWLEDGED


def test_a_target_at_once_replaces_the_one_before(rig):
    master = profiled(rig)
    start = master.upload(0x6062)
    side = 1 if start < 50_000 else -1
    master.outputs[0x607A, 0] = start + side * 20_000
    master.cycle(ENABLE | NEW)
    demands(master, ENABLE, 60)
    found = moves(master, start, AT_ONCE)
    assert found[-1] == start
    speeds = [(b - a) * 1000 for a, b in zip(found, found[1:])]
    assert max(abs(b - a) for a, b in zip(speeds, speeds[1:])) <= 2000 + 2000


def test_relative_targets_add_to_the_last_one(rig):
    master = profiled(rig)
    start = master.upload(0x6062)
    way = 3000 if start < 50_000 else -3000
    assert moves(master, way, RELATIVE)[-1] == start + way
    assert moves(master, way, RELATIVE)[-1] == start + 2 * way


def test_a_bit_that_stays_set_is_one_target(rig):
    master = profiled(rig)
    start = master.upload(0x6062)
    way = 3000 if start < 50_000 else -3000
    master.outputs[0x607A, 0] = way
    assert demands(master, ENABLE | NEW | RELATIVE, 400)[-1] == start + way


def test_the_position_window_counts_time_at_the_axis(rig):
    master = profiled(rig)
    master.download(0x6067, 0, 400)
    master.download(0x6068, 0, 20)
    start = master.upload(0x6062)
    master.outputs[0x607A, 0] = start + (5000 if start < 50_000 else -5000)
    master.cycle(ENABLE | NEW)
    inside = 0
    for _ in range(1000):
        word = master.cycle(ENABLE)
        at_end = master.upload(0x6062) == master.outputs[0x607A, 0]
        inside = inside + 1 if at_end and abs(master.upload(0x60F4)) <= 400 else 0
        assert bool(word & REACHED) == (inside > 20)
        if inside > 40:
            break
    assert inside > 40


def test_targets_beyond_the_limits_end_there_and_say_so(rig):
    master = profiled(rig, speed=1_000_000)
    master.outputs[0x607A, 0] = 150_000
    assert master.cycle(ENABLE | NEW) & LIMITED
    assert demands(master, ENABLE, 900)[-1] == 100_000
    assert master.cycle(ENABLE) & REACHED


def test_the_speed_is_that_of_max_profile_velocity_at_most(rig):
    master = profiled(rig)
    master.download(0x607F, 0, 30_000)
    start = master.upload(0x6062)
    found = moves(master, start + (5000 if start < 50_000 else -5000))
    assert max(abs(b - a) for a, b in zip(found, found[1:])) <= 31


def test_profile_velocity_ramps_reverses_and_stops(rig):
    master = profiled(rig, PV)
    side = 1 if master.upload(0x6062) < 50_000 else -1
    speeds = []
    for target, ticks in ((60_000, 100), (-60_000, 200), (0, 100)):
        master.outputs[0x60FF, 0] = side * target
        found = [master.upload(0x6062), *demands(master, ENABLE, ticks)]
        speeds.append([side * (b - a) * 1000 for a, b in zip(found, found[1:])])
        word = master.cycle(ENABLE)
        assert word & REACHED
        assert bool(word & ACKNOWLEDGED) == (target == 0)
    # 2 mm/s a tick up, 1 mm/s a tick down; 1 um more by rounding.
    assert speeds[0][:3] == [pytest.approx(2000 * k, abs=1000) for k in (1, 2, 3)]
    assert speeds[0][-1] == speeds[1][0] + 1000 == 60_000
    assert speeds[1][-1] == -60_000
    assert speeds[2][0] == pytest.approx(-59_000, abs=1000) and speeds[2][-1] == 0


def test_profile_velocity_brakes_ahead_of_the_limit(rig):
    master = profiled(rig, PV)
    start = master.upload(0x6062)
    master.download(0x607D, 2, start + 5000)
    master.outputs[0x60FF, 0] = 100_000
    found = demands(master, ENABLE, 300)
    assert max(found) == found[-1] == start + 5000
    speeds = [(b - a) * 1000 for a, b in zip(found, found[1:])]
    assert min(b - a for a, b in zip(speeds, speeds[1:])) >= -1000 - 2000
    assert master.inputs[POSITION] < start + 5000 + 1000


def test_profile_velocity_says_that_the_limit_takes_its_speed(rig):
    """From the tick on in which 100 mm/s could no longer stop, 5 mm ahead: v^2 / 2d + v T / 2."""
    master = profiled(rig, PV)
    start = master.upload(0x6062)
    master.download(0x607D, 2, start + 20_000)
    master.outputs[0x60FF, 0] = 100_000
    found = []
    for _ in range(500):
        before = master.upload(0x6062)
        found.append((before, bool(master.cycle(ENABLE) & LIMITED)))
    assert found[-1] == (start + 20_000, True)
    for place, is_limited in found:
        if abs(place - (start + 14_950)) > 1:
            assert is_limited == (place > start + 14_950)
    master.outputs[0x60FF, 0] = -50_000     # away from it
    assert not master.cycle(ENABLE) & LIMITED
    master.cycle(ENABLE)
    master.download(0x607D, 2, start + 10_000)      # the reference is beyond it now
    master.outputs[0x60FF, 0] = 10_000
    assert master.cycle(ENABLE) & LIMITED


@pytest.mark.parametrize('mode', [PP, PV, CSP, CSV])
@pytest.mark.parametrize(('option', 'rate'), [(1, 1000), (2, None)])
def test_a_halt_brakes_and_goes_on(rig, mode, option, rate):
    """By 0x6084, 1 m/s2, or by 0x6085; it stays enabled."""
    master = profiled(rig, mode)
    master.download(0x605D, 0, option)
    rate = rate or master.upload(0x6085) // 1000
    start = master.upload(0x6062)
    side = 1 if start < 50_000 else -1
    master.outputs[0x60FF, 0] = side * 60_000
    for k in range(80):
        if mode == CSP:
            master.outputs[0x607A, 0] = start + side * 60 * (k + 1)
        elif mode == PP:
            master.outputs[0x607A, 0] = start + side * 30_000
        word = master.cycle(ENABLE | NEW)
    found = [master.upload(0x6062), *demands(master, ENABLE | NEW | HALT, 120)]
    speeds = [side * (b - a) * 1000 for a, b in zip(found, found[1:])]
    changes = [a - b for a, b in zip(speeds, speeds[1:])]
    assert speeds[0] > 0 and speeds[-1] == 0
    assert max(changes) <= rate + 2000
    assert sum(one > 0 for one in speeds) == pytest.approx(
        (speeds[0] + rate) / rate, abs=2)
    word = master.cycle(ENABLE | NEW | HALT)
    assert state(word) == 'OPERATION_ENABLED'
    if mode in (PP, PV):
        assert word & REACHED       # at rest
    else:
        assert not word & 1 << 12   # it does not follow
    if mode != CSP:
        assert side * (demands(master, ENABLE | NEW, 60)[-1] - found[-1]) > 1000


def test_the_position_offset_is_added_in_mode_8(rig):
    master = enabled(rig)
    target = master.inputs[POSITION]
    master.download(0x60B0, 0, 250)
    master.cycle(ENABLE, x607A=target)
    assert rig.simulation.applied[0]['position'] == pytest.approx((target + 250) * UM)


def test_digital_inputs_show_the_position_limits(rig):
    master = Master(rig)
    here = master.upload(0x6064)
    assert master.upload(0x60FD) == 0
    master.download(0x607D, 1, here)
    assert master.upload(0x60FD) == 1
    master.download(0x607D, 2, here)
    assert master.upload(0x60FD) == 3


def test_a_profile_follows_within_its_window_or_is_a_fault(rig):
    master = profiled(rig, speed=0xFFFFFFFF, acceleration=0xFFFFFFFF, deceleration=0xFFFFFFFF)
    master.download(0x6065, 0, 2000)
    start = master.upload(0x6062)
    master.outputs[0x607A, 0] = start + (30_000 if start < 50_000 else -30_000)
    master.cycle(ENABLE | NEW)
    master.cycle_until(lambda word: state(word) == 'FAULT', ENABLE, most=400)
    assert master.upload(0x603F) == 0x8611
    master.cycle(RESET)
    for word in (0, SHUTDOWN, SWITCH_ON, ENABLE, ENABLE):
        reached = master.cycle(word)
    assert state(reached) == 'OPERATION_ENABLED' and master.upload(0x6062) != start


def test_a_mode_that_begins_with_bit_4_set_starts_nothing(rig):
    master = enabled(rig)
    start = master.inputs[POSITION]
    master.outputs[0x607A, 0] = start + 5000
    master.cycle(ENABLE | NEW, x6060=PP)
    assert abs(demands(master, ENABLE | NEW, 50)[-1] - start) < 6000
    assert not master.cycle(ENABLE | NEW) & ACKNOWLEDGED
