"""Largest torques of a CiA 402 drive limit efforts, and the force towards a position."""

import pytest

from ..master_402 import CSP, ENABLE, enabled, IMPEDANCE
from ..rig import Master, Rig


@pytest.mark.parametrize(('index', 'moves', 'largest'), [
    (0x6072, 20000, 750.0), (0x6072, -20000, -750.0), (0x60E0, 20000, 750.0),
    (0x60E1, -20000, -750.0), (0x60E1, 20000, 2000.0), (0x60E0, -20000, -2000.0)])
def test_the_force_towards_a_position_is_limited_too(rig, index, moves, largest):
    """100 per mille of 7500 N in modes 8 and -1; a stiffness of 1e5 N/m wants 2000 N at 20 mm."""
    # 1e-9 N: what 20 mm between two positions round to, times the stiffness.
    master = enabled(rig)
    start = master.upload(0x6064)
    master.download(index, 0, 100)
    for mode in (CSP, IMPEDANCE):
        master.outputs[0x2010, 2] = 0.0
        master.cycle(ENABLE, x6060=mode, x607A=start + moves)
        demand = rig.sample['force_reference']
        assert abs(demand) <= abs(largest) + 1e-9 and demand * largest > 0.7 * largest * largest
    assert master.upload(0x2030, 3) == 7500.0      # the limit of the block stays as it was
    master.download(index, 0, 1000)
    master.cycle(ENABLE)
    assert limits(rig) == (7500.0, 5174.0)


def limits(rig):
    """Return the limits of the position block that are in force."""
    ram = rig.simulation.group.actuators[0]
    return ram.parameter('position.force_out'), ram.parameter('position.force_in')


def test_the_smaller_of_max_torque_and_the_limit_of_the_block_is_in_force(rig):
    master = enabled(rig)
    master.download(0x2030, 3, 2000.0)
    master.cycle(ENABLE)
    assert limits(rig) == (2000.0, 5174.0)
    master.download(0x6072, 0, 100)
    master.cycle(ENABLE)
    assert limits(rig) == (750.0, 750.0)
    master.download(0x2030, 4, 500.0)
    master.cycle(ENABLE)
    assert limits(rig) == (750.0, 500.0)
    rig.device.take_changes({'position.force_out': 600.0})     # from ROS
    master.download(0x6072, 0, 50)
    master.cycle(ENABLE)
    assert limits(rig) == (375.0, 375.0)
    rig.device.take_changes({'position.force_out': 375.0, 'position.force_in': 375.0})
    master.download(0x6072, 0, 1000)
    master.cycle(ENABLE)
    assert limits(rig) == (600.0, 500.0)
    assert (master.upload(0x2030, 3), master.upload(0x2030, 4)) == (600.0, 500.0)


def test_no_torque_is_the_least_limit_that_a_block_can_have(rig):
    master = enabled(rig)
    master.download(0x6072, 0, 0)
    master.cycle(ENABLE, x607A=0)
    assert limits(rig) == (1e-3, 1e-3)


def test_an_actuator_without_a_position_block_takes_max_torque_for_its_efforts_only():
    rig = Rig('rig_valve')
    Master(rig).download(0x6072, 0, 10)
    assert rig.device.changes() == {}
