"""Gains and limits of the REU as objects: validated, in force at the next tick, recorded."""

import struct

import isa_ros
from isa_ros.actuator.tunable import tunables
from isa_ros.fieldbus.device import abort
from isa_ros.fieldbus.device.abort import SdoAbort
import pytest

from .rig import Master, Rig


@pytest.fixture
def master():
    return Master(Rig())


def single(value):
    """Return a number rounded to single precision."""
    return struct.unpack('<f', struct.pack('<f', value))[0]


def place(master, name):
    return next((one.index, one.subindex) for one in master.device.table.entries
                if one.name == name)


@pytest.mark.parametrize('name', ['rig_linear', 'rig_rotary', 'rig_rotary_position', 'rig_valve'])
def test_every_tunable_of_the_reu_is_an_object(name):
    run = isa_ros.load(name).configuration
    master = Master(Rig(name))
    for own in tunables(run.actuators[0].sheet).values():
        key = place(master, own.name)
        entry = master.device.table.entry(*key)
        assert master.upload(*key) == single(own.value)
        assert (entry.unit, entry.access) == (own.unit, 'rw')


def test_a_gain_is_in_force_at_the_next_tick_and_recorded(master):
    master.download(*place(master, 'force.kp'), 1e-7)
    master.cycle(0)
    assert master.rig.simulation.tuned == {0: {'force.kp': single(1e-7)}}
    master.cycle(0)
    assert master.rig.simulation.tuned == {}


def test_the_gain_of_the_impedance_is_a_command(master):
    for control in (6, 7, 15, 15):
        master.cycle(control, x6060=8)
    master.download(*place(master, 'position.stiffness'), 5e4)
    master.cycle(15)
    assert master.rig.simulation.applied[0]['stiffness'] == 5e4


@pytest.mark.parametrize(('name', 'value', 'code'), [
    ('force.kp', -1.0, abort.TOO_LOW), ('force.kp', 1.0, abort.TOO_HIGH),
    ('force.limit', 0.0, abort.OUT_OF_RANGE), ('force.limit', 0.1, abort.TOO_HIGH)])
def test_a_gain_that_the_reu_refuses_is_refused_as_a_whole(master, name, value, code):
    key = place(master, name)
    before = master.upload(*key)
    with pytest.raises(SdoAbort) as refused:
        master.download(*key, value)
    assert refused.value.code == code
    assert master.upload(*key) == before
    assert master.device.changes() == {}


def test_the_reason_of_the_reu_is_an_object(master):
    with pytest.raises(SdoAbort):
        master.download(*place(master, 'force.limit'), 0.1)
    reason = master.upload(0x2003)
    assert 'force.limit' in reason
    assert len(reason) <= master.device.table.entry(0x2003).bits // 8 == 255


def test_a_gain_that_is_tuned_elsewhere_shows(master):
    master.device.take_changes({'force.kp': 2e-7, 'plant.spool.stuck': 1.0})
    assert master.upload(*place(master, 'force.kp')) == single(2e-7)
    assert master.device.changes() == {}
