"""Distributed clocks: delays that a master measures, its epoch, and steps of simulated time."""

import struct

from isa_ros.fieldbus.ethercat.clock import HOP_NS
import pytest
from tests.fieldbus.ethercat.raw_master import ARMW, at, BWR, RawMaster, Sent, STEP_NS
from tests.fieldbus.toys import Toy

EPOCH = 848_646_511_285_098_123
"""A wall clock in ns since 2000."""


@pytest.fixture
def three() -> RawMaster:
    """Return three slaves after two ticks."""
    master = RawMaster(Toy('a'), Toy('b', 2), Toy('c', 3))
    master.tick()
    master.tick()
    return master


def start(master: RawMaster) -> None:
    """Set offsets and delays as SOEM does."""
    master.send(Sent(BWR, at(0, 0x0900), bytes(4)))
    for slave in range(3):
        received = master.number(0x0918, 8, slave)
        master.write(0x0920, struct.pack('<q', EPOCH - received), slave)
        master.write(0x0928, struct.pack('<I', slave * HOP_NS), slave)


def system_times(master: RawMaster) -> list[int]:
    """Return the system time of each slave."""
    return [master.number(0x0910, 8, slave) for slave in range(3)]


def test_a_master_finds_the_delays_between_slaves(three):
    """Half of what the loops of neighbours differ by is the delay between them."""
    three.send(Sent(BWR, at(0, 0x0900), bytes(4)))
    loops = []
    for slave in range(3):
        port_0, port_1 = struct.unpack_from('<II', three.read(0x0900, 16, slave))
        loops.append(port_1 - port_0)
    assert [(a - b) // 2 for a, b in zip(loops, loops[1:])] == [HOP_NS, HOP_NS]
    assert loops[-1] == 0
    assert three.number(0x0918, 8) == 2 * STEP_NS


def test_system_time_has_the_masters_epoch_and_stands_still_between_ticks(three):
    start(three)
    assert three.number(0x0910, 8) == three.number(0x0910, 8) == EPOCH


def test_all_clocks_are_equal_after_the_reference_has_been_sent_round(three):
    start(three)
    three.send(Sent(ARMW, at(0, 0x0910), bytes(8)))
    for k in range(3):
        assert system_times(three) == [EPOCH + k * STEP_NS + slave * HOP_NS for slave in range(3)]
        three.tick()
    assert [three.number(0x092C, 4, slave) for slave in range(3)] == [0, 0, 0]


def test_a_correction_across_the_32_bit_boundary_is_the_short_way(three):
    three.write(0x0920, struct.pack('<q', (1 << 32) - 2 * STEP_NS - 100), 0)
    three.write(0x0920, struct.pack('<q', (1 << 32) - 2 * STEP_NS + 100 - HOP_NS), 1)
    three.send(Sent(ARMW, at(0, 0x0910), bytes(8)))
    assert three.number(0x0910, 8, 1) == (1 << 32) - 100


def test_a_restart_of_the_control_loop_forgets_the_correction(three):
    start(three)
    before = system_times(three)
    three.send(Sent(ARMW, at(0, 0x0910), bytes(8)))
    assert system_times(three) != before
    three.send(Sent(BWR, at(0, 0x0930), b'\x00\x10'))
    assert system_times(three) == before


def test_a_start_of_sync0_in_the_past_is_shown(three):
    start(three)
    for time, status in ((EPOCH + STEP_NS, 0x01), (EPOCH - STEP_NS, 0x05)):
        three.write(0x0990, struct.pack('<Q', time))
        three.write(0x0981, b'\x03')
        assert three.number(0x0984, 1) == status
    three.write(0x0981, b'\x00')
    assert three.number(0x0984, 1) == 0


# In real time.

class Host:
    """A clock of the test's own, ns."""

    def __init__(self) -> None:
        self.now = 7_000_000_000

    def __call__(self) -> int:
        return self.now


@pytest.fixture
def host(three) -> Host:
    """Return the host time that three slaves run with after two ticks."""
    found = Host()
    three.line.keep_host_time(found)
    return found


def test_in_real_time_the_clocks_run_between_ticks_and_not_with_them(three, host):
    start(three)
    three.send(Sent(ARMW, at(0, 0x0910), bytes(8)))
    assert system_times(three) == [EPOCH, EPOCH + HOP_NS, EPOCH + 2 * HOP_NS]
    host.now += 123_456
    assert three.number(0x0910, 8) == EPOCH + 123_456
    three.tick()
    assert three.number(0x0910, 8) == EPOCH + 123_456


def test_in_real_time_a_frame_reads_one_time_at_all_slaves(three, host):
    ticking = three.line.ring.clock._host
    three.line.ring.clock._host = lambda: (setattr(host, 'now', host.now + 999), ticking())[1]
    three.send(Sent(BWR, at(0, 0x0900), bytes(4)))
    loops = [struct.unpack('<II', three.read(0x0900, 8, slave)) for slave in range(3)]
    assert [(b - a) for a, b in loops] == [4 * HOP_NS, 2 * HOP_NS, 0]
    assert [b[0] - a[0] for a, b in zip(loops, loops[1:])] == [HOP_NS, HOP_NS]


def test_a_master_that_steers_by_the_clocks_locks_in_real_time(three, host):
    """
    The controller of SOEM's examples: a 100th of the phase, a 20th of the integral of its sign.

    From any phase it comes within the 2 us by which the sign swings, at 50 us after the cycle.
    """
    start(three)
    host.now += 420_000
    integral, phases = 0, []
    for _ in range(3000):
        phase = (three.number(0x0910, 8) - 50_000) % STEP_NS
        phase -= STEP_NS if phase > STEP_NS // 2 else 0
        integral += (phase > 0) - (phase < 0)
        host.now += STEP_NS - phase // 100 - integral // 20
        three.tick()
        phases.append(phase)
    assert abs(phases[0]) > 300_000
    assert max(map(abs, phases[-500:])) < 2000


def test_in_frame_pace_a_master_sees_one_phase_for_ever(three):
    """Steering is of no use there: a frame is a tick whenever it arrives."""
    start(three)
    phases = set()
    for _ in range(50):
        phases.add((three.number(0x0910, 8) - EPOCH) % STEP_NS)
        three.tick()
    assert phases == {0}


def test_ticks_are_due_at_sync0(three, host):
    start(three)
    three.send(Sent(ARMW, at(0, 0x0910), bytes(8)))
    assert three.line.until_sync() == 0.0
    three.write(0x0990, struct.pack('<Q', EPOCH + 10 * STEP_NS + 250_000), 1)
    three.write(0x0981, b'\x03', 1)
    host.now += 100_000 - HOP_NS        # the second slave's clock is a hop ahead
    assert three.line.until_sync() == pytest.approx(150e-6, rel=0.0, abs=1e-12)
    host.now += 200_000
    assert three.line.until_sync() == pytest.approx(950e-6, rel=0.0, abs=1e-12)
