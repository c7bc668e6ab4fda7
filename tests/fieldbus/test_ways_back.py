"""What a drive was told before is over: gains, targets, holds, enables."""

from isa_ros.core.device import DISABLED, ENABLED
from isa_ros.core.signals import COMMAND, HAS_ENABLE
import numpy as np
import pytest

from .master_402 import (
    CSP, CSV, ENABLE, enabled, IMPEDANCE, is_in, SHUTDOWN, state, SWITCH_ON)
from .rig import Master, Rig


def test_velocity_mode_adds_the_velocity_offset(rig):
    master = enabled(rig, CSV)
    start = master.upload(0x6062)
    for _ in range(100):
        master.cycle(ENABLE, x60FF=50000, x60B1=-20000)
    assert master.upload(0x6062) - start == pytest.approx(100 * 30, abs=30)     # um; one tick
    assert rig.simulation.applied[0]['velocity'] == pytest.approx(0.03)


def test_a_reset_bit_makes_no_command_of_enable_operation(rig):
    master = Master(rig)
    for word in (0, SHUTDOWN, SWITCH_ON):
        master.cycle(word)
    assert state(master.cycle(ENABLE | 0x80)) == 'SWITCHED_ON'
    assert state(master.cycle(ENABLE)) == 'OPERATION_ENABLED'


def test_the_gains_of_the_block_come_back_in_one_command_only(rig):
    """Later ticks keep what is in force, so that gains tuned from elsewhere are not undone."""
    master = enabled(rig, IMPEDANCE)
    master.outputs[0x2010, 1] = 2.5e4
    master.cycle(ENABLE)
    master.cycle(ENABLE, x6060=CSP)
    assert rig.commands[0]['stiffness'] == 1e5
    for _ in range(3):
        master.cycle(ENABLE)
        assert np.isnan(rig.commands[0]['stiffness']) and np.isnan(rig.commands[0]['damping'])


def test_a_second_enable_waits_for_a_slow_reu_as_the_first_did(rig):
    """The samples of a slow REU show disabled a tick longer, which is not dropped."""
    master = enabled(rig)
    master.cycle(ENABLE)
    master.cycle(SWITCH_ON)
    assert rig.sample['device_state'] == DISABLED
    old = rig.sample.copy()
    master.download(0x6040, 0, ENABLE)
    command = np.zeros(1, COMMAND)[0]
    rig.device.fill_command(command)
    assert command['kinds'] & HAS_ENABLE and command['is_enabled']
    rig.device.take_sample(old, rig.simulation.ticks)
    assert state(master.upload(0x6041)) == 'OPERATION_ENABLED'
    master.cycle_until(is_in('OPERATION_ENABLED'), ENABLE, most=1)
    assert rig.sample['device_state'] == ENABLED


def test_a_hold_of_cia_408_is_at_the_position_measured_when_it_was_entered():
    master = Master(Rig(profile='cia408'))
    master.outputs[0x6043, 0] = 7
    for word in (0b0001, 0b0011, 0b0111):
        master.cycle(word)
    first = master.upload(0x6610, 1)
    master.outputs[0x6500, 1] = 50000
    for _ in range(300):
        master.cycle(0b0111)
    before = master.upload(0x6601, 1)
    assert before - first > 5000
    master.cycle(0b0011)
    assert master.upload(0x6610, 1) == before
    for _ in range(5):
        master.cycle(0b0011)
    assert master.upload(0x6610, 1) == before


@pytest.mark.parametrize(('profile', 'mode', 'key'), [
    ('cia402', CSP, (0x60B1, 0)), ('cia402', CSV, (0x60FF, 0)), ('cia402', IMPEDANCE, (0x60FF, 0)),
    ('cia408', 7, (0x6500, 1))])
def test_velocities_beyond_full_opening_are_limited_and_say_so(profile, mode, key):
    rig = Rig(profile=profile)
    master = enabled(rig, mode) if profile == 'cia402' else Master(rig)
    master.outputs[key] = -2_000_000_000
    if profile == 'cia408':
        master.outputs[0x6043, 0] = mode
    words = [master.cycle(ENABLE if profile == 'cia402' else 0b0111) for _ in range(4)]
    assert words[-1] & (1 << 11 if profile == 'cia402' else 1 << 10)
    # The speed at full opening is that of MIT frames at power-on, as REAL32.
    assert rig.simulation.applied[0]['velocity'] == pytest.approx(
        -master.upload(0x2002, 2), rel=2.0 ** -23)
