"""Conditions of the device as error codes, emergency messages, and the error register."""

import isa_ros
from isa_ros.core.conditions import BITS, CONDITIONS
from isa_ros.core.signals import SAMPLE
from isa_ros.fieldbus.device.devices import devices_of
from isa_ros.fieldbus.device.faults import EMERGENCY_STOP, OWN_CODES, stopping_bits
from isa_ros.reu.protection_sheet import reaction_of
from isa_ros.tick.emergency_stop import LINE
import numpy as np
import pytest

RUN = isa_ros.load('rig_linear').configuration
PROTECTION = RUN.actuators[0].sheet.reu.protection
REGISTER_OF = {0x2: 1 << 1, 0x3: 1 << 2, 0x4: 1 << 3, 0x7: 1 << 5, 0xF: 1 << 7}
"""Bit of the error register by the first digit of a code; 0x81 and 0x82 are communication."""
FAULT = 5


class Fed:
    """A device that is given samples."""

    def __init__(self):
        self.device, = devices_of(RUN)
        self.sample = np.zeros(1, SAMPLE)[0]
        self.tick = 0
        self.take()

    def take(self, trips=0, state=1):
        """Take a sample with these conditions, and return the codes that are reported."""
        self.sample['trips'], self.sample['device_state'] = trips, state
        self.device.take_sample(self.sample, self.tick)
        self.tick += 1
        return [one.code for one in self.device.emergencies()]

    def stop(self, is_open):
        """Open or close the line of the emergency stop; return the codes that are reported."""
        self.device.take_changes({LINE: float(is_open)})
        return [one.code for one in self.device.emergencies()]

    def upload(self, index, subindex=0):
        return int.from_bytes(self.device.read(index, subindex), 'little')


def test_every_condition_has_a_code_of_its_own():
    errors = [condition.error for condition in CONDITIONS]
    codes = [one.code for one in (*errors, *OWN_CODES)]
    assert len(set(codes)) == len(codes)


@pytest.mark.parametrize('condition', BITS)
def test_the_register_has_the_bit_of_the_code(condition):
    own = CONDITIONS[BITS[condition]].error
    expected = 1 << 4 if own.code >> 8 in (0x81, 0x82) else (
        1 << 5 if own.code >> 12 == 8 else REGISTER_OF[own.code >> 12])
    assert own.register == expected


@pytest.mark.parametrize('condition', BITS)
def test_each_trip_is_reported_once_and_its_end_too(condition):
    fed, bit = Fed(), 1 << BITS[condition]
    own = CONDITIONS[BITS[condition]].error
    is_stopping = bool(stopping_bits(PROTECTION) & bit)
    assert is_stopping == (
        reaction_of(PROTECTION, condition) in ('quick_stop', 'disable', 'block'))
    state = FAULT if is_stopping else 1
    assert fed.take(bit, state) == [own.code]
    assert fed.take(bit, state) == []
    assert fed.upload(0x1001) == own.register | 1
    assert fed.upload(0x603F) == own.code * is_stopping
    assert (fed.upload(0x1003), fed.upload(0x1003, 1)) == (1, own.code | (bit & 0xFFFF) << 16)
    assert fed.take(0, 1) == [0]
    assert fed.upload(0x1001) == fed.upload(0x603F) == 0


def test_the_code_of_a_fault_is_that_of_its_first_cause():
    fed = Fed()
    first, later = 1 << BITS['supply_low'], 1 << BITS['overtemperature']
    fed.take(first, FAULT)
    assert fed.take(first | later, FAULT) == [CONDITIONS[BITS['overtemperature']].error.code]
    assert fed.upload(0x603F) == CONDITIONS[BITS['supply_low']].error.code
    assert fed.take(later, FAULT) == []
    assert fed.take(0, 1) == [0]


def test_the_error_field_keeps_the_last_eight_newest_first():
    fed = Fed()
    for bit in range(10):
        fed.take(1 << bit)
    assert fed.upload(0x1003) == 8
    assert [fed.upload(0x1003, k) & 0xFFFF for k in range(1, 9)] == [
        CONDITIONS[bit].error.code for bit in range(9, 1, -1)]


def test_the_data_of_a_message_are_the_bits_of_all_trips():
    fed = Fed()
    fed.sample['trips'] = 0b1000_0000_0010
    fed.device.take_sample(fed.sample, 1)
    for one in fed.device.emergencies():
        assert (int.from_bytes(one.data, 'little'), len(one.data)) == (0b1000_0000_0010, 5)


def test_an_open_emergency_stop_is_told_once_and_no_end_before_its_release():
    """A trip that comes and goes meanwhile: its end is not the end of all errors."""
    fed, bit = Fed(), 1 << BITS['supply_low']
    code = CONDITIONS[BITS['supply_low']].error.code
    assert fed.stop(True) == [EMERGENCY_STOP.code] and fed.stop(True) == []
    assert fed.take(bit) == [code] and fed.take() == []
    assert fed.stop(False) == [0] and fed.stop(False) == []
    assert fed.stop(True) == [EMERGENCY_STOP.code] and fed.take(bit) == [code]
    assert fed.stop(False) == [] and fed.take() == [0]
