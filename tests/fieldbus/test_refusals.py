"""Object 0x2003: why the last request was refused, whatever was wrong with it."""

import math
import struct

from isa_ros.fieldbus.device.abort import SdoAbort
import pytest

from .master_402 import ENABLE, enabled
from .rig import Master, Rig


@pytest.fixture(scope='module')
def master():
    return Master(Rig())


@pytest.mark.parametrize(('key', 'value', 'reason'), [
    ((0x6072, 0), 2000, '0x6072:0 Max torque = 2000, must be <= 1000'),
    ((0x607D, 1), -1, '0x607D:1 Least position = -1, must be >= 0'),
    ((0x605A, 0), 3, '0x605A:0 Quick stop option code = 3, must be 0, 2, 6'),
    ((0x6041, 0), 0, '0x6041:0: attempt to write a read only object'),
    ((0x2010, 1), -5.0, '0x2010:1 Stiffness = -5, must be >= 0'),
    ((0x2010, 1), math.inf, '0x2010:1 Stiffness = inf, must be finite'),
    ((0x2010, 2), math.nan, '0x2010:2 Damping = nan, must be finite'),
    ((0x2010, 2), 2e7, '0x2010:2 Damping = 20000000, must be <= 16076760'),
    ((0x2010, 3), -math.inf, '0x2010:3 Effort = -inf, must be finite'),
    ((0x1600, 1), 0x60400010,
     '0x1600:1: data cannot be transferred or stored in the present state of the device')])
def test_a_write_that_is_refused_says_why(master, key, value, reason):
    with pytest.raises(SdoAbort):
        master.download(*key, value)
    assert master.upload(0x2003) == reason


def test_objects_that_do_not_exist_and_wrong_lengths_say_so(master):
    with pytest.raises(SdoAbort):
        master.device.read(0x5FFF, 0)
    assert master.upload(0x2003) == '0x5FFF:0: object does not exist in the object dictionary'
    with pytest.raises(SdoAbort):
        master.device.write(0x6072, 0, b'\0', is_preoperational=True)
    assert master.upload(0x2003).startswith('0x6072:0: data type does not match')
    with pytest.raises(SdoAbort):
        master.device.write_all(0x1A10, b'\0', is_preoperational=True)
    assert master.upload(0x2003).startswith('0x1A10: data type does not match')
    with pytest.raises(SdoAbort):
        master.device.read_all(0x6041)
    assert master.upload(0x2003) == '0x6041: complete access not supported for this object'


def test_a_limit_beyond_what_the_valve_can_have_is_refused_by_its_range(master):
    with pytest.raises(SdoAbort):
        master.download(0x2031, 9, 1.0)
    assert master.upload(0x2003) == '0x2031:9 force.limit = 1, must be <= 0.000178178'


def test_limits_that_cross_have_their_numbers(master):
    master.download(0x607D, 2, 60000)
    with pytest.raises(SdoAbort):
        master.download(0x607D, 1, 60001)
    assert master.upload(0x2003) == (
        '0x607D: least position 60001 above largest position 60000, um | urad')


def test_short_process_data_say_so(master):
    master.device.receive(0x1610, bytes(5))
    assert master.upload(0x2003) == '0x1610: 5 bytes of process data, must be >= 28'


def test_gains_of_process_data_beyond_their_range_are_limited():
    rig = Rig()
    master = enabled(rig, -1)
    for stiffness, applied in ((-5.0, 0.0), (math.inf, 5e7)):
        master.outputs[0x2010, 1], master.outputs[0x2010, 2] = stiffness, 0.0
        assert master.cycle(ENABLE) & 1 << 11
        assert rig.simulation.applied[0]['stiffness'] == applied
        assert struct.unpack('<f', rig.device.read(0x2010, 1))[0] == stiffness


@pytest.mark.parametrize('profile', ['cia402', 'cia408'])
def test_a_mode_of_process_data_that_is_refused_reads_back_as_the_one_in_force(profile):
    """By mail and by process data; the reason stays."""
    mode, shown = {'cia402': (0x6060, 0x6061), 'cia408': (0x6043, 0x6043)}[profile]
    rig = Rig(profile=profile)
    master = Master(rig)
    rig.tick()
    before = rig.device.read(mode, 0)
    content = bytearray(rig.device.size(0x1610))
    content[2] = 99     # after the control word
    rig.device.receive(0x1610, bytes(content))
    assert rig.device.read(mode, 0) == before == rig.device.read(shown, 0)
    assert '99 does not exist here' in master.upload(0x2003)


def test_an_integer_of_process_data_beyond_its_range_is_not_taken():
    """A limit of 60 times the rated force would be none."""
    rig = Rig()
    words = [0x60720010, 0x60E00010, 0x60400010]
    for k, word in ((0, 0), *enumerate(words, 1), (0, len(words))):
        entry = rig.device.table.entry(0x1600, k)
        rig.device.write(0x1600, k, entry.data_type.pack(word), is_preoperational=True)
    rig.device.receive(0x1600, struct.pack('<3H', 500, 700, 6))
    rig.device.receive(0x1600, struct.pack('<3H', 60000, 800, 7))
    found = [int.from_bytes(rig.device.read(index, 0), 'little')
             for index in (0x6072, 0x60E0, 0x6040)]
    assert found == [500, 800, 7]
    assert Master(rig).upload(0x2003) == '0x6072:0 Max torque = 60000, must be <= 1000'
