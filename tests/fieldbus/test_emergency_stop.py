"""The emergency stop as the master of a bus sees it: states, codes, and the way back."""

from isa_ros.core.device import DISABLED, ENABLED, QUICK_STOP
from isa_ros.core.signals import SAMPLE
from isa_ros.fieldbus.device.rest import Rest
import numpy as np
import pytest

from .master_402 import ENABLE, enabled, is_in, SHUTDOWN, state, STOP, SWITCH_ON
from .rig import Master, Rig

CODE, REGISTER = 0x603F, 0x1001


def codes(rig):
    """Return the codes of the emergency messages since the last call."""
    found, rig.emergencies = [one.code for one in rig.emergencies], []
    return found


@pytest.mark.parametrize(('kind', 'option'), [
    ('ramp', 2), ('ramp', 6), ('ramp_and_hold', 6), ('ramp_and_hold', 2)])
def test_a_drive_in_operation_stops_and_cannot_be_switched_on_before_the_release(kind, option):
    """Quick stop active, then switch on disabled, whatever the option code; no fault."""
    rig = Rig(changes={'actuators.ram.parameters.reu.device.quick_stop': kind})
    master = enabled(rig)
    master.download(0x605A, 0, option)
    master.cycle(ENABLE)
    assert codes(rig) == [] and master.upload(CODE) == 0
    rig.simulation.emergency_stop()
    assert state(master.cycle(ENABLE)) == 'QUICK_STOP'
    assert rig.sample['device_state'] == QUICK_STOP
    assert codes(rig) == [0x9000]
    assert (master.upload(CODE), master.upload(REGISTER)) == (0x9000, 1)
    master.cycle_until(is_in('SWITCH_ON_DISABLED'), ENABLE)
    assert rig.sample['device_state'] == DISABLED
    for control in (SHUTDOWN, SWITCH_ON, ENABLE, STOP, SHUTDOWN):
        assert state(master.cycle(control)) == 'SWITCH_ON_DISABLED'
    assert rig.sample['refused_requests'] == 0.0
    rig.simulation.emergency_stop(False)
    master.cycle(ENABLE)
    assert codes(rig) == [0]
    assert (master.upload(CODE), master.upload(REGISTER)) == (0, 0)
    assert state(master.cycle(ENABLE)) == 'SWITCH_ON_DISABLED'      # nothing starts by itself
    assert [state(master.cycle(control)) for control in (SHUTDOWN, SWITCH_ON, ENABLE)] == [
        'READY', 'SWITCHED_ON', 'OPERATION_ENABLED']
    master.cycle(ENABLE)
    assert rig.sample['device_state'] == ENABLED


def test_a_stop_that_is_released_while_it_brakes_ends_off_all_the_same():
    rig = Rig()
    master = enabled(rig)
    master.download(0x605A, 0, 6)
    rig.simulation.emergency_stop()
    master.cycle(ENABLE)
    rig.simulation.emergency_stop(False)
    states = [state(master.cycle(ENABLE)) for _ in range(300)]
    assert states[0] == 'QUICK_STOP' and states[-1] == 'SWITCH_ON_DISABLED'
    assert 'OPERATION_ENABLED' not in states


@pytest.mark.parametrize('controls', [(SHUTDOWN,), (SHUTDOWN, SWITCH_ON)])
def test_a_drive_that_is_ready_loses_its_voltage(controls):
    rig = Rig()
    master = Master(rig)
    for control in controls:
        master.cycle(control)
    rig.simulation.emergency_stop()
    master.cycle(controls[-1])
    assert state(master.cycle(controls[-1])) == 'SWITCH_ON_DISABLED'


def test_a_drive_that_is_not_yet_enabled_in_operation_leaves_it():
    """Else it would show operation enabled, without any."""
    rig = Rig()
    master = Master(rig)
    for control in (SHUTDOWN, SWITCH_ON):
        master.cycle(control)
    rig.simulation.emergency_stop()
    states = [state(master.cycle(ENABLE)) for _ in range(4)]
    assert states[-1] == 'SWITCH_ON_DISABLED' and rig.sample['device_state'] == DISABLED


def test_a_device_of_cia_408_that_is_not_yet_enabled_does_not_stay_in_hold():
    """The line opens in the tick that its master asks for hold in; nothing enables the REU."""
    rig = Rig(profile='cia408')
    master = Master(rig)
    master.cycle(0b0001)
    rig.simulation.emergency_stop()
    for _ in range(3):
        word = master.cycle(0b0011)
    assert rig.sample['device_state'] == DISABLED and word & 0xF == 0b1001


def test_shutdown_is_not_obeyed_for_a_moment_while_a_stop_is_open():
    """Not even between the tick's command and its sample, when a mailbox may ask."""
    rig = Rig()
    master = Master(rig)
    master.cycle(0)
    rig.simulation.emergency_stop()
    master.cycle(0)
    rig.device.receive(0x1610, SHUTDOWN.to_bytes(rig.device.size(0x1610), 'little'))
    rig.device.fill_command(rig.commands[0])
    assert state(master.upload(0x6041)) == 'SWITCH_ON_DISABLED'


def test_a_fault_keeps_its_code_beside_the_stop_and_the_last_end_is_told():
    rig = Rig()
    master = enabled(rig)
    rig.simulation.tune('ram', {'plant.sensors.force.bias': 3000.0})
    master.cycle_until(is_in('FAULT'), ENABLE)
    fault, = codes(rig)
    rig.simulation.emergency_stop()
    master.cycle(0)
    assert codes(rig) == [0x9000] and master.upload(CODE) == fault
    rig.simulation.emergency_stop(False)
    master.cycle(0)
    assert codes(rig) == [] and master.upload(REGISTER) & 1
    rig.simulation.tune('ram', {'plant.sensors.force.bias': 0.0})
    for _ in range(5):
        master.cycle(0)
    master.cycle_until(is_in('SWITCH_ON_DISABLED'), 0x80)
    assert codes(rig) == [0]


def test_a_device_of_cia_408_is_disabled_until_the_release_and_a_new_edge():
    rig = Rig(profile='cia408')
    master = Master(rig)
    master.outputs[0x6043, 0] = 7
    for word in (0b0001, 0b0011, 0b0111, 0b0111):
        master.cycle(word)
    assert rig.sample['device_state'] == ENABLED
    rig.simulation.emergency_stop()
    for _ in range(300):
        master.cycle(0b0111)
    assert rig.sample['device_state'] == DISABLED and master.upload(0x6041) & 0xF == 0b0001 | 8
    for word in (0b0001, 0b0011):
        master.cycle(word)
    assert rig.sample['device_state'] == DISABLED and rig.sample['refused_requests'] == 0.0
    rig.simulation.emergency_stop(False)
    for word in (0b0001, 0b0011, 0b0011):
        master.cycle(word)
    assert rig.sample['device_state'] == ENABLED


def test_a_reaction_that_has_become_weaker_is_no_fault_of_the_drive():
    """It had the reactions of the sheet: a trip that only warned left its code in 0x603F."""
    rig = Rig()
    master = enabled(rig)
    rig.simulation.tune('ram', {'reu.protection.load_cell_implausible.reaction': 'warn',
                                'plant.sensors.force.bias': 3000.0})
    for _ in range(100):
        word = master.cycle(ENABLE)
    assert codes(rig) == [0x7300] and master.upload(CODE) == 0
    assert state(word) == 'OPERATION_ENABLED'
    other = Rig()
    master = enabled(other)
    other.simulation.tune('ram', {'reu.protection.overspeed.reaction': 'disable',
                                  'reu.protection.overspeed.trip': 0.001,
                                  'reu.protection.overspeed.warning': 0.0005})
    for k in range(60):
        master.cycle(ENABLE, x607A=master.outputs[0x607A, 0] + 200)
    assert master.upload(CODE) == 0x8400


@pytest.mark.parametrize('is_lost', [False, True])
def test_an_option_code_that_ends_off_ends_the_hold_of_the_reu(is_lost):
    """0x605A = 2 on `ramp_and_hold`: 200 ms at rest, then off; it stayed for ever."""
    rig = Rig(changes={'actuators.ram.parameters.reu.device.quick_stop': 'ramp_and_hold'})
    master = enabled(rig)
    master.download(0x605A, 0, 2)
    for _ in range(60):
        master.cycle(ENABLE, x607A=master.outputs[0x607A, 0] + 200)
    assert abs(rig.sample['velocity']) > 0.1
    if is_lost:
        master.device.end_operation(is_lost=True)
        expected = 'FAULT'
    else:
        assert state(master.cycle(STOP)) == 'QUICK_STOP'
        expected = 'SWITCH_ON_DISABLED'
    began = rig.simulation.t
    while rig.sample['device_state'] != DISABLED:
        rig.tick()
        moving = abs(rig.sample['velocity'])
        assert rig.simulation.t < began + 0.5
    assert 0.2 < rig.simulation.t - began < 0.35 and moving < 1e-3
    assert state(master.upload(0x6041)) == expected


def test_a_load_that_does_not_stand_is_waited_for_by_two_seconds():
    rig = Rig(changes={'actuators.ram.parameters.reu.device.quick_stop': 'ramp_and_hold'})
    axis = rig.device._axis
    rest = Rest(axis)
    sample = np.zeros(1, SAMPLE)[0]
    sample['device_state'] = QUICK_STOP
    for k in range(2000):
        assert not rest.is_over
        sample['position'] = 0.05 + (2e-4 if k % 100 < 50 else 0.0)
        axis.take_sample(sample)
        rest.watch()
    assert rest.is_over
    sample['device_state'] = ENABLED
    axis.take_sample(sample)
    rest.watch()
    assert not rest.is_over


def test_an_reu_that_ends_its_stop_by_itself_is_not_ended_by_the_drive():
    rig = Rig(changes={'actuators.ram.parameters.reu.device.quick_stop': 'ramp'})
    axis = rig.device._axis
    rest = Rest(axis)
    sample = np.zeros(1, SAMPLE)[0]
    sample['device_state'] = QUICK_STOP
    for _ in range(2100):
        axis.take_sample(sample)
        rest.watch()
    assert not rest.is_over
