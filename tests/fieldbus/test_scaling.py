"""Counts on the bus and SI in the actuator: there and back."""

import struct

from hypothesis import given, settings, strategies as st
import isa_ros
from isa_ros.actuator.tunable import tunables
from isa_ros.core.signals import COMMAND, SAMPLE
from isa_ros.fieldbus.device.devices import devices_of
import numpy as np
import pytest
from tests.sheets import actuator_sheet

from .rig import FORMATS

RUNS = {name: isa_ros.load(name).configuration for name in ('rig_linear', 'rig_rotary')}
ENABLED = 2
TARGETS = struct.Struct('<Hbxiiihhff')
CSP, CST, IMPEDANCE = 8, 10, -1


def device_of(name):
    """Return a device that has enabled operation, its sample and a command."""
    device, = devices_of(RUNS[name])
    sample, command = np.zeros(1, SAMPLE)[0], np.zeros(1, COMMAND)[0]
    sample['device_state'] = 1
    device.take_sample(sample, 0)
    for word in (6, 7, 15):
        device.receive(0x1610, TARGETS.pack(word, CSP, 0, 0, 0, 0, 0, 0.0, 0.0))
        device.fill_command(command)
    sample['device_state'] = ENABLED
    device.take_sample(sample, 1)
    return device, sample, command


DEVICES = {name: device_of(name) for name in RUNS}
LINEAR = device_of('rig_linear')
RATED = 7500.0


@pytest.mark.parametrize('name', RUNS)
@settings(max_examples=50, deadline=None)
@given(share=st.floats(-1.5, 1.5))
def test_what_is_measured_is_right_to_half_a_count(name, share):
    """Beyond the type it saturates; a real number has 24 bits."""
    device, sample, _ = DEVICES[name]
    table = [one for one in device.table.entries if one.source and not one.source.startswith(
        ('device_', 'warnings', 'trips'))]
    for entry in table:
        low, high = entry.data_type.limits if entry.data_type.is_integer else (-1e9, 1e9)
        sample[entry.source] = share * high * entry.scale
        device.take_sample(sample, 2)
        read, = struct.unpack(f'<{FORMATS[entry.data_type.name]}',
                              device.read(entry.index, entry.subindex))
        if entry.data_type.is_integer:
            expected = min(max(sample[entry.source] / entry.scale, low), high)
            # half a count; beyond 2^24 counts the quotient of doubles adds less than 1e-6 of one
            assert abs(read - expected) <= 0.5 + 1e-6
        else:
            assert read == np.float32(sample[entry.source])


@settings(deadline=None)
@given(position=st.integers(0, 100_000), velocity=st.integers(-1_600_000, 1_600_000))
def test_targets_are_the_decimal_numbers_that_were_counted(position, velocity):
    device, _, command = LINEAR
    device.receive(0x1610, TARGETS.pack(
        15, IMPEDANCE, position, velocity, 0, 0, 0, float('nan'), float('nan')))
    device.fill_command(command)
    assert command['position'] == float(f'{position}e-6')
    assert command['velocity'] == float(f'{velocity}e-6')
    assert np.isnan(command['stiffness']) and np.isnan(command['damping'])


@settings(deadline=None)
@given(torque=st.integers(-690, 1000), offset=st.integers(-200, 200))
def test_torques_are_per_mille_of_the_rated_force(torque, offset):
    device, _, command = LINEAR
    device.receive(0x1610, TARGETS.pack(15, CST, 0, 0, 0, torque, offset, 0.0, 0.0))
    device.fill_command(command)
    expected = min(max((torque + offset) * RATED / 1000, -5174.0), RATED)
    assert command['effort'] == pytest.approx(expected, rel=1e-12, abs=1e-9)


LARGEST_DAMPING = tunables(actuator_sheet('isa_v5'))['position.damping'].bounds['le']


@settings(deadline=None)
@given(stiffness=st.floats(-1e6, 1e8, width=32), damping=st.floats(-1e6, 2.0 ** 25, width=32))
def test_gains_are_those_that_were_sent_within_their_ranges(stiffness, damping):
    device, _, command = LINEAR
    device.receive(0x1610, TARGETS.pack(15, IMPEDANCE, 0, 0, 0, 0, 0, stiffness, damping))
    device.fill_command(command)
    assert command['stiffness'] == min(max(stiffness, 0.0), 5e7)     # its load cell
    assert command['damping'] == min(max(damping, 0.0), LARGEST_DAMPING)
