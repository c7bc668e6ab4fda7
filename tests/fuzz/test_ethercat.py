"""No frame makes a slave fail, hang, or leave its states."""

from isa_ros.fieldbus.ethercat import controller, datagrams, ring
from isa_ros.fieldbus.ethercat.application_layer import ApplicationLayer
from isa_ros.fieldbus.ethercat.slave import Slave
import pytest
from tests.fuzz.ethercat_door import actuators, fuzz
from tests.fuzz.property import Broken

CASES, FEW, MANY = 10_000, 1500, 300_000


def test_every_frame_is_answered_or_discarded():
    assert fuzz(CASES, 1) > CASES // 2


def test_every_frame_to_actuators_is_answered_or_discarded():
    assert fuzz(FEW, 3, actuators) > FEW // 2


@pytest.mark.long
def test_every_one_of_many_frames_is_answered_or_discarded():
    fuzz(MANY, 2)


@pytest.mark.parametrize('plant', [
    lambda patch: patch.setattr(ring, 'is_ethercat', lambda frame, size: size >= 16),
    lambda patch: patch.setattr(datagrams, 'COUNTER', 0),
    lambda patch: patch.setattr(controller, 'END', 0x10000),
    lambda patch: patch.setattr(controller, '_WRITABLE', b'\x01' * 0x1000),
    lambda patch: patch.setattr(ApplicationLayer, '_refusal', lambda self, wanted: 0),
    lambda patch: patch.setattr(Slave, '_process_data_refusal', lambda self: 0)])
def test_a_guard_that_is_missing_is_found(plant, monkeypatch):
    plant(monkeypatch)
    with pytest.raises(Broken):
        fuzz(CASES, 1)
