"""Whatever a master sends, the device commands only what its actuator accepts."""

import struct

from hypothesis import given, settings, strategies as st
import isa_ros
from isa_ros.actuator.setpoint_range import SetpointRange
from isa_ros.core.signals import COMMAND, EVERY_KIND, SAMPLE
from isa_ros.errors import SetpointError
from isa_ros.fieldbus.device.abort import SdoAbort
from isa_ros.fieldbus.device.devices import devices_of, PROFILES
from isa_ros.fieldbus.device.setpoints import Limiter
import numpy as np
import pytest

RUNS = {name: isa_ros.load(name).configuration
        for name in ('rig_linear', 'rig_rotary', 'rig_rotary_position', 'rig_valve')}
WORDS = {'cia402': (0, 6, 7, 15, 15, 15, 0x1F, 0x7F, 0x10F, 15, 2, 0x80, 0x8F),
         'cia408': (0, 1, 3, 7, 7, 7, 8, 15)}
SHOWN = {'cia402': {0x00, 0x40, 0x21, 0x23, 0x27, 0x07, 0x0F, 0x08},
         'cia408': {0b0000, 0b1000, 0b1001, 0b1011, 0b1111, 0b0001, 0b0011, 0b0111}}
MASKS = {'cia402': 0x6F, 'cia408': 0x0F}
STEPS = st.lists(st.tuples(
    st.integers(0), st.binary(min_size=64, max_size=64), st.sampled_from(range(6)),
    st.sampled_from((-1, 0, 1, 2, 3, 5, 6, 7, 8, 9, 10)), st.sampled_from('tttttttlbe')),
    min_size=1, max_size=40)


@pytest.mark.parametrize('name', RUNS)
@pytest.mark.parametrize('profile', PROFILES)
@settings(max_examples=15, deadline=None)
@given(steps=STEPS, trips=st.integers(0, 4095))
def test_every_command_is_admitted(name, profile, steps, trips):
    own = RUNS[name].actuators[0]
    device = devices_of(RUNS[name], profile)[0]
    admits = SetpointRange(own.name, own.sheet)
    sample, command = np.zeros(1, SAMPLE)[0], np.zeros(1, COMMAND)[0]
    sample['position'] = own.initial_position
    device.take_sample(sample, 0)
    for tick, (place, data, state, mode, event) in enumerate(steps):
        word = WORDS[profile][place % len(WORDS[profile])]
        content = struct.pack('<Hb', word, mode) + data
        device.receive(0x1610, content[:device.size(0x1610)])
        if event == 'l':
            device.end_operation(is_lost=bool(place % 2))
        elif event == 'b':
            device.begin_operation()
        command['kinds'] = 0
        device.fill_command(command)
        assert 0 <= int(command['kinds']) <= EVERY_KIND
        assert admits.admit(command) == ''
        assert all(np.isfinite(command[field]) for field in ('position', 'velocity', 'effort'))
        assert all(not command[field] < 0.0 for field in ('stiffness', 'damping'))
        sample['device_state'], sample['device_mode'] = state, 6
        sample['trips'] = trips if event == 'e' else 0.0
        device.take_sample(sample, tick + 1)
        shown = int.from_bytes(device.read(0x6041, 0), 'little') & MASKS[profile]
        assert shown in SHOWN[profile]
        assert len(device.transmit(0x1A10)) == device.size(0x1A10)
        device.emergencies()


def test_without_the_limits_a_command_is_not_admitted(monkeypatch):
    """The check above finds a limit that is missing."""
    monkeypatch.setattr(Limiter, 'limited', lambda self, value, low, high: value)
    run = RUNS['rig_linear']
    device, = devices_of(run)
    sample, command = np.zeros(1, SAMPLE)[0], np.zeros(1, COMMAND)[0]
    sample['device_state'] = 1
    device.take_sample(sample, 0)
    for word in (6, 7, 15):
        device.receive(0x1610, struct.pack('<Hbxi', word, 8, 10 ** 9) + bytes(20))
        device.fill_command(command)
    with pytest.raises(SetpointError):
        SetpointRange('ram', run.actuators[0].sheet).admit(command)


@pytest.mark.parametrize('profile', PROFILES)
@settings(max_examples=60, deadline=None)
@given(index=st.one_of(st.integers(0, 0xFFFF), st.sampled_from(range(0x1000, 0x2040)),
                       st.sampled_from(range(0x6000, 0x6700))),
       subindex=st.integers(0, 255), data=st.binary(max_size=80), is_preoperational=st.booleans(),
       place=st.integers(0))
def test_an_access_is_answered_or_refused_by_a_code(
        profile, index, subindex, data, is_preoperational, place):
    device, = devices_of(RUNS['rig_linear'], profile)
    if place % 2:
        entry = device.table.entries[place % len(device.table.entries)]
        index, subindex = entry.index, entry.subindex
    for access in (
            lambda: device.read(index, subindex), lambda: device.read_all(index),
            lambda: device.write(index, subindex, data, is_preoperational=is_preoperational),
            lambda: device.write_all(index, data, is_preoperational=is_preoperational)):
        try:
            access()
        except SdoAbort:
            continue
    for assignment in (0x1C12, 0x1C13):
        for pdo in device.assigned(assignment):
            assert len(device.transmit(pdo)) == device.size(pdo)
