"""Homing: the present position becomes the offset of the home."""

import pytest

from .master_402 import CSP, ENABLE, enabled, POSITION

HM = 6
NEW = 1 << 4
REACHED, ACKNOWLEDGED, FAILED = 1 << 10, 1 << 12, 1 << 13


@pytest.mark.parametrize('method', [35, 37])
def test_homing_gives_the_present_position_the_home_offset(rig, method):
    master = enabled(rig, HM)
    encoder = master.inputs[POSITION]
    master.download(0x607C, 0, -12_345)
    master.download(0x6098, 0, method)
    word = master.cycle(ENABLE)
    assert word & (REACHED | ACKNOWLEDGED | FAILED) == REACHED
    word = master.cycle(ENABLE | NEW)
    assert word & (REACHED | ACKNOWLEDGED | FAILED) == REACHED | ACKNOWLEDGED
    assert master.inputs[POSITION] == pytest.approx(-12_345, abs=20)    # of a tick's creeping
    origin = encoder + 12_345
    assert master.upload(0x6062) == master.inputs[POSITION]
    target = master.inputs[POSITION]
    master.cycle(ENABLE, x6060=CSP, x607A=target)
    assert rig.simulation.applied[0]['position'] == pytest.approx(rig.sample['position'], abs=1e-4)
    master.cycle(ENABLE, x607A=-origin - 1)     # a micrometre below the encoder's 0
    assert rig.simulation.applied[0]['position'] == pytest.approx(0.0, abs=20e-6)
    master.device.end_operation(is_lost=False)
    master.device.restart(is_whole=True)
    assert master.upload(0x6064) == round(rig.sample['position'] * 1e6)


def test_homing_without_a_method_fails(rig):
    master = enabled(rig, HM)
    master.download(0x6098, 0, 0)
    before = master.inputs[POSITION]
    word = master.cycle(ENABLE | NEW)
    assert word & (ACKNOWLEDGED | FAILED) == FAILED
    assert abs(master.inputs[POSITION] - before) < 50
    master.download(0x6098, 0, 37)
    master.cycle(ENABLE)
    assert master.cycle(ENABLE | NEW) & (ACKNOWLEDGED | FAILED) == ACKNOWLEDGED
