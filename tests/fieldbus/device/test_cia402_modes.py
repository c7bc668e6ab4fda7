"""Modes of a CiA 402 drive: what its targets do, in which units, and which are refused."""

import math

from isa_ros.fieldbus.device.abort import OUT_OF_RANGE, SdoAbort
import pytest

from ..master_402 import (
    CSP, CST, CSV, ENABLE, enabled, IMPEDANCE, MODE_SHOWN, POSITION, TORQUE, VELOCITY)
from ..rig import Rig


def test_position_mode_moves_to_the_target_in_micrometres(rig):
    master = enabled(rig)
    start = master.upload(0x6064)
    for k in range(700):
        target = start + min(20 * k, 10000)
        master.cycle(ENABLE, x607A=target)
    # Stiffness 1e5 N/m bears 50 kg: 490 N are 4.9 mm; without effort it hangs that much lower.
    assert abs(master.inputs[POSITION] - target) < 5200
    assert master.inputs[POSITION] == round(rig.sample['position'] * 1e6)
    assert master.upload(0x6062) == target
    assert master.upload(0x60F4) == target - master.inputs[POSITION]


def test_velocity_mode_integrates_the_target_velocity(rig):
    master = enabled(rig, CSV)
    start = master.upload(0x6062)
    for _ in range(200):
        master.cycle(ENABLE, x60FF=50000)
    assert master.upload(0x6062) - start == pytest.approx(200 * 50, abs=50)
    for _ in range(100):
        master.cycle(ENABLE)
    # The friction of the seals is the only load along the reference: it lags, but as fast.
    assert master.inputs[VELOCITY] == pytest.approx(50000, rel=0.15)


def test_torque_mode_gives_the_force_in_per_mille_of_the_rated_one(rig):
    master = enabled(rig, CST)
    rated = master.upload(0x6076) * 1e-3
    assert rated == 7500.0
    for _ in range(60):
        master.cycle(ENABLE, x6071=100, x60B2=20)
    assert rig.sample['force_reference'] == pytest.approx(0.12 * rated)
    assert master.inputs[TORQUE] == round(rig.sample['force'] / rated * 1000)
    assert rig.sample['device_mode'] == 4


def test_impedance_mode_takes_stiffness_and_damping_of_the_process_data(rig):
    master = enabled(rig, IMPEDANCE)
    master.outputs[0x2010, 1], master.outputs[0x2010, 2] = 2.5e4, 1500.0
    master.cycle(ENABLE)
    assert rig.sample['device_mode'] == 6
    applied = rig.simulation.applied[0]
    assert (applied['stiffness'], applied['damping']) == (2.5e4, 1500.0)
    master.outputs[0x2010, 1] = math.nan
    master.cycle(ENABLE)
    assert rig.simulation.applied[0]['stiffness'] == 2.5e4


def test_position_mode_restores_the_gains_of_the_block(rig):
    master = enabled(rig, IMPEDANCE)
    master.outputs[0x2010, 1], master.outputs[0x2010, 2] = 2.5e4, 1500.0
    master.cycle(ENABLE)
    master.cycle(ENABLE, x6060=CSP)
    applied = rig.simulation.applied[0]
    assert (applied['stiffness'], applied['damping']) == (1e5, 4000.0)


def test_no_mode_holds_the_position(rig):
    master = enabled(rig, 0)
    start = rig.sample['position']
    for _ in range(50):
        word = master.cycle(ENABLE)
    assert not word & 1 << 12
    assert rig.sample['position'] == pytest.approx(start, abs=0.006)  # 490 N of 1e5 N/m


def test_a_mode_begins_at_the_present_position(rig):
    """Not at the demand of the mode before: here a target 20 mm away."""
    master = enabled(rig)
    master.download(0x6065, 0, 0xFFFFFFFF)
    away = 20000 if master.inputs[POSITION] < 50000 else -20000
    master.cycle(ENABLE, x607A=master.inputs[POSITION] + away)
    present = master.inputs[POSITION]
    master.cycle(ENABLE, x6060=CSV, x60FF=0)
    assert master.upload(0x6062) == pytest.approx(present, abs=1)


def test_modes_change_while_enabled(rig):
    master = enabled(rig, CSP)
    for mode, own in ((CST, 4), (CSV, 6), (IMPEDANCE, 6), (CSP, 6)):
        master.cycle(ENABLE, x6060=mode)
        assert (master.inputs[MODE_SHOWN], rig.sample['device_mode']) == (mode, own)


@pytest.mark.parametrize(('mode', 'reason'), [
    (2, 'velocity is a mode of frequency converters: use mode 9'),
    (4, 'profile torque has no ramp in the drive: send one in mode 10'),
    (5, 'mode 5 does not exist here; there are -1, 0, 1, 3, 6, 8, 9, 10')])
def test_other_modes_are_refused_with_a_reason(rig, mode, reason):
    master = enabled(rig)
    with pytest.raises(SdoAbort) as refused:
        master.download(0x6060, 0, mode)
    assert refused.value.code == OUT_OF_RANGE
    assert master.upload(0x2003) == reason
    master.download(0x6066, 0, 1)
    other = enabled(Rig())
    other.cycle(ENABLE, x6060=mode)
    assert other.inputs[MODE_SHOWN] == CSP
    assert other.upload(0x2003) == reason


@pytest.mark.parametrize(('config', 'bits'), [
    ('rig_linear', 0b1110100101 | 1 << 16), ('rig_rotary_position', 0b0110100101),
    ('rig_valve', 0)])
def test_supported_modes_are_those_of_the_wiring(config, bits):
    assert int.from_bytes(Rig(config).device.read(0x6502, 0), 'little') == bits


def test_a_rotary_actuator_counts_microradians():
    rig = Rig('rig_rotary_position')
    master = enabled(rig)
    assert master.upload(0x60A8) == 0xFA100000
    assert master.inputs[POSITION] == round(rig.sample['position'] * 1e6)
