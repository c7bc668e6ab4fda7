"""Gains, effort and signals as integers, for masters that map integers only."""

import struct

from isa_ros.fieldbus.device.devices import devices_of
from isa_ros.fieldbus.device.objects import DataType
import pytest

from ..master_402 import CSP, ENABLE, enabled, IMPEDANCE, SHUTDOWN, SWITCH_ON
from ..rig import Master, Rig

KEEPS = 0xFFFFFFFF


def applied(rig):
    row = rig.simulation.applied[0]
    return float(row['stiffness']), float(row['damping'])


@pytest.mark.parametrize('profile', ['cia402', 'cia408'])
def test_the_integer_pdos_have_no_real_numbers(rig, profile):
    device, = devices_of(rig.simulation.scenario.run, profile)
    pdos = [one for one in (0x1611, 0x1A11) if one in device.table]
    assert len(pdos) == (2 if profile == 'cia402' else 1)
    for pdo in pdos:
        words = [int.from_bytes(device.read(pdo, k + 1), 'little')
                 for k in range(device.read(pdo, 0)[0])]
        types = {device.table.entry(word >> 16, word >> 8 & 0xFF).data_type
                 for word in words if word >> 16}
        assert types and DataType.REAL32 not in types
        assert device.size(pdo) == device.size(pdo - 1)
        assert pdo in device.table.entry(0x1C12 if pdo < 0x1A00 else 0x1C13, 1).choices


def test_a_master_drives_the_impedance_by_integers(rig):
    master = Master(rig, (0x1611, 0x1A11))
    master.outputs[0x607A, 0] = master.upload(0x6064)
    master.outputs[0x2011, 1], master.outputs[0x2011, 2] = 25000, 1500
    for control in (SHUTDOWN, SWITCH_ON, ENABLE, ENABLE):
        master.cycle(control, x6060=IMPEDANCE)
    assert applied(rig) == (25000.0, 1500.0)
    assert (master.upload(0x2010, 1), master.upload(0x2010, 2)) == (25000.0, 1500.0)
    assert master.inputs[0x2027, 1] == round(rig.sample['pressure_a'])
    assert master.inputs[0x2027, 2] == round(rig.sample['pressure_b'])
    assert master.inputs[0x2027, 4] == round(rig.sample['spool'] * 1e9)
    master.outputs[0x2011, 1] = KEEPS
    master.outputs[0x2011, 2] = 700
    master.cycle(ENABLE)
    assert applied(rig) == (25000.0, 700.0)


def test_signals_are_counted_in_their_units(rig):
    master = enabled(rig)
    for subindex, field, scale in ((3, 'supply_pressure', 1.0), (5, 'current', 1e-6),
                                   (6, 'force', 1e-3), (7, 'temperature', 0.01)):
        assert master.upload(0x2027, subindex) == round(float(rig.sample[field]) / scale)


def test_what_is_written_last_counts_and_both_show_it(rig):
    master = Master(rig)
    assert (master.upload(0x2011, 1), master.upload(0x2011, 2)) == (100000, 4000)
    master.download(0x2011, 1, 1234)
    assert master.upload(0x2010, 1) == 1234.0
    master.download(0x2010, 1, 99.0)
    assert master.upload(0x2011, 1) == 99
    master.download(0x2011, 3, -2500)
    assert (master.upload(0x2010, 3), master.upload(0x2011, 3)) == (-2.5, -2500)
    master.download(0x2011, 2, KEEPS)
    assert master.upload(0x2010, 2) != master.upload(0x2010, 2)     # NaN
    assert master.upload(0x2011, 2) == KEEPS
    master.download(0x2010, 3, 3e6)
    assert master.upload(0x2011, 3) == 0x7FFFFFFF


def test_the_effort_of_the_integer_is_that_of_the_setpoint(rig):
    master = enabled(rig, IMPEDANCE)
    master.download(0x2011, 3, 125_500)
    master.cycle(ENABLE)
    assert rig.simulation.applied[0]['effort'] == 125.5
    master.device.write(0x2011, 3, struct.pack('<I', KEEPS), is_preoperational=False)
    assert master.upload(0x2010, 3) == pytest.approx(-1e-3)     # of an effort it is a number


def test_gains_of_a_rotary_actuator_are_in_thousandths():
    rig = Rig('leg')
    master = Master(rig)
    master.download(0x2011, 1, 250_500)
    assert master.upload(0x2010, 1) == 250.5


def test_mode_8_takes_the_gains_of_mode_minus_1_if_it_is_told_so(rig):
    master = enabled(rig, CSP)
    master.outputs[0x2010, 1], master.outputs[0x2010, 2] = 2.5e4, 1500.0
    master.cycle(ENABLE)
    assert applied(rig) == (1e5, 4000.0)
    master.download(0x2012, 0, 1)
    master.cycle(ENABLE)
    assert applied(rig) == (2.5e4, 1500.0)
    master.download(0x2012, 0, 0)
    master.cycle(ENABLE)
    assert applied(rig) == (1e5, 4000.0)
