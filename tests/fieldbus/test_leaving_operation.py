"""A bus that leaves operational stops the drive, although no tick passes until it is back."""

from isa_ros.core.device import DISABLED as OFF, ENABLED, FAULT, QUICK_STOP
from isa_ros.fieldbus.device.abort import SdoAbort
from isa_ros.fieldbus.device.cia402_states import State402
from isa_ros.fieldbus.device.devices import devices_of
import pytest
from tests.fieldbus.canopen.virtual_bus import (
    RESET_COMMUNICATION, RESET_NODE, START, STEP_NS, STOP as NMT_STOP, TO_PREOPERATIONAL,
    virtual_master)
from tests.fieldbus.ethercat.raw_master import INIT as AL_INIT, OP, PREOP, RawMaster, SAFEOP

from .master_402 import (
    CSP, CSV, ENABLE, enabled, is_in, SHUTDOWN, state, STOP, SWITCH_ON, VOLTAGE_OFF)
from .rig import Master, Rig

SHORT_STOP = {'actuators.ram.parameters.reu.device.quick_stop_hold_ms': 5.0}
REMOTE = 1 << 9
INIT, DISABLED, HOLD, ACTIVE, R = 0b0000, 0b0001, 0b0011, 0b0111, 0b1000


def moving(velocity=50000):
    """Return a master whose drive moves in mode 9, um/s."""
    master = enabled(Rig(changes=SHORT_STOP), CSV)
    for _ in range(50):
        master.cycle(ENABLE, x60FF=velocity)
    return master


def test_a_bus_that_comes_back_at_once_finds_the_drive_stopping():
    """With the control word that enabled it, without a tick between: OP -> PREOP -> OP."""
    master = moving()
    master.device.end_operation(is_lost=False)
    word = master.upload(0x6041)
    assert (state(word), word & REMOTE) == ('QUICK_STOP', 0)
    master.device.begin_operation()
    assert state(master.cycle(ENABLE)) == 'QUICK_STOP'
    assert master.rig.sample['device_state'] == QUICK_STOP
    for _ in range(40):
        word = master.cycle(ENABLE)
    assert (state(word), word & REMOTE) == ('SWITCH_ON_DISABLED', REMOTE)
    assert master.rig.sample['device_state'] == OFF
    assert not master.rig.emergencies
    for control in (SHUTDOWN, SWITCH_ON, ENABLE, ENABLE):
        word = master.cycle(control)
    assert (state(word), master.rig.sample['device_state']) == ('OPERATION_ENABLED', ENABLED)


@pytest.mark.parametrize('words', [(SHUTDOWN,), (SHUTDOWN, SWITCH_ON)])
def test_below_operation_enabled_the_drive_is_switched_off_at_once(words):
    rig = Rig()
    master = Master(rig)
    for word in (VOLTAGE_OFF, *words):
        master.cycle(word)
    rig.device.end_operation(is_lost=False)
    assert state(master.upload(0x6041)) == 'SWITCH_ON_DISABLED'


@pytest.mark.parametrize(('control', 'option', 'reached'), [
    (SHUTDOWN, 0x605B, 'READY'), (SWITCH_ON, 0x605C, 'SWITCHED_ON')])
def test_shutdown_and_disable_operation_stop_before_they_are_off_by_option_1(
        control, option, reached):
    """By option 0 they are off at once, whatever the other two options are."""
    for code, own in ((0, OFF), (1, QUICK_STOP)):
        master = moving()
        master.download(0x605A, 0, 0)
        master.download(0x605B, 0, code if option == 0x605B else 1 - code)
        master.download(0x605C, 0, code if option == 0x605C else 1 - code)
        assert state(master.cycle(control)) == reached
        assert master.rig.sample['device_state'] == own
        for _ in range(60):
            word = master.cycle(control)
        assert (state(word), master.rig.sample['device_state']) == (reached, OFF)


def test_a_stop_before_it_is_off_is_cut_by_disable_voltage():
    master = moving()
    master.download(0x605C, 0, 1)
    master.cycle(SWITCH_ON)
    assert state(master.cycle(VOLTAGE_OFF)) == 'SWITCH_ON_DISABLED'
    assert master.rig.sample['device_state'] == OFF


@pytest.mark.parametrize(('code', 'own'), [(0, OFF), (2, QUICK_STOP)])
def test_a_lost_bus_stops_the_drive_by_the_fault_reaction_code(code, own):
    master = moving()
    master.download(0x605E, 0, code)
    master.device.end_operation(is_lost=True)
    master.rig.tick()
    assert master.rig.sample['device_state'] == own
    for _ in range(60):
        master.rig.tick()
    assert (state(master.upload(0x6041)), master.rig.sample['device_state']) == ('FAULT', OFF)


@pytest.mark.parametrize(('kind', 'refused'), [('close', True), ('ramp_and_hold', True),
                                               ('ramp', False)])
def test_a_quick_stop_that_does_not_ramp_and_end_cannot_come_before_off(kind, refused):
    """One that closes does not ramp; one that holds would never be off."""
    master = enabled(Rig(changes={'actuators.ram.parameters.reu.device.quick_stop': kind}), CSP)
    for option in (0x605B, 0x605C):
        if refused:
            with pytest.raises(SdoAbort, match='0x06090030'):
                master.download(option, 0, 1)
        else:
            master.download(option, 0, 1)


def test_option_6_does_not_enable_a_drive_again_whose_bus_has_left():
    master = moving()
    master.download(0x605A, 0, 6)
    for _ in range(2):      # also in the middle of a quick stop that the master began
        master.device.end_operation(is_lost=False)
        master.device.begin_operation()
        states = [state(master.cycle(ENABLE)) for _ in range(60)]
        assert states[0] == 'QUICK_STOP' and states[-1] == 'SWITCH_ON_DISABLED'
        assert 'OPERATION_ENABLED' not in states
        for control in (SHUTDOWN, SWITCH_ON, ENABLE, ENABLE):
            master.cycle(control)
        assert state(master.cycle(STOP)) == 'QUICK_STOP'
    master.cycle_until(lambda word: master.rig.sample['device_state'] != QUICK_STOP, STOP)
    assert state(master.cycle(ENABLE)) == 'OPERATION_ENABLED'     # by option 6: the bus stayed


def test_a_drive_held_by_option_6_is_switched_off_by_whoever_wants_it():
    rig = Rig()
    master = enabled(rig)
    master.download(0x605A, 0, 6)
    for _ in range(300):
        master.cycle(STOP)
    rig.simulation.command('ram', is_enabled=False)
    rig.commands['kinds'] = 0
    rig.simulation.step(rig.commands)
    rig.device.take_sample(rig.sample, rig.simulation.ticks)
    for _ in range(5):
        assert state(master.cycle(STOP)) == 'QUICK_STOP'
        assert rig.sample['device_state'] == OFF
    other = enabled(Rig())
    other.download(0x605A, 0, 6)
    for _ in range(300):
        other.cycle(STOP)
    other.device.end_operation(is_lost=False)
    other.rig.tick()
    assert other.rig.sample['device_state'] == QUICK_STOP
    third = enabled(Rig())
    third.download(0x605A, 0, 6)
    for _ in range(300):
        third.cycle(STOP)
    assert state(third.cycle(VOLTAGE_OFF)) == 'SWITCH_ON_DISABLED'
    assert third.rig.sample['device_state'] == OFF


def test_a_restart_of_the_bus_is_switch_on_disabled_at_once_and_lets_the_stop_end():
    """As by INIT of EtherCAT, or by reset communication."""
    master = moving()
    master.device.end_operation(is_lost=False)
    master.device.restart(is_whole=False)
    assert state(master.upload(0x6041)) == 'SWITCH_ON_DISABLED'
    master.device.begin_operation()
    seen = []
    for control in (SHUTDOWN, SWITCH_ON, *[ENABLE] * 60):
        word = master.cycle(control)
        seen.append((state(word), int(master.rig.sample['device_state'])))
    assert [own for _, own in seen[:3]] == [QUICK_STOP] * 3
    assert seen[2][0] == 'SWITCHED_ON'      # not enabled before the stop has ended
    assert seen[-1] == ('OPERATION_ENABLED', ENABLED)


def test_a_restart_of_the_bus_with_option_0_is_off_at_once():
    master = moving()
    master.download(0x605A, 0, 0)
    master.device.end_operation(is_lost=False)
    master.device.restart(is_whole=False)
    master.rig.tick()
    assert master.rig.sample['device_state'] == OFF


def test_a_whole_restart_is_off_at_once_with_the_values_of_power_on():
    master = moving()
    master.download(0x6065, 0, 20000)
    master.device.end_operation(is_lost=False)
    master.device.restart(is_whole=True)
    assert state(master.upload(0x6041)) == 'SWITCH_ON_DISABLED'
    assert (master.upload(0x6040), master.upload(0x6060), master.upload(0x6061)) == (0, 0, 0)
    assert master.upload(0x6065) == 0xFFFFFFFF
    assert master.upload(0x607A) == master.upload(0x6064)
    master.rig.tick()
    assert master.rig.sample['device_state'] == OFF


def test_a_restart_of_the_bus_keeps_a_fault_and_a_whole_one_forgets_it():
    master = moving()
    master.device.end_operation(is_lost=True)
    for _ in range(40):
        master.rig.tick()
    master.device.restart(is_whole=False)
    assert (state(master.upload(0x6041)), master.upload(0x603F)) == ('FAULT', 0x8180)
    master.device.restart(is_whole=True)
    assert (state(master.upload(0x6041)), master.upload(0x603F)) == ('SWITCH_ON_DISABLED', 0)
    assert (master.upload(0x1001), master.upload(0x1003)) == (0, 0)


@pytest.mark.parametrize('ticks', [0, 100])
def test_a_whole_restart_clears_a_fault_of_the_reu_once_its_cause_is_gone(ticks):
    """Both in the reaction, and in the fault behind it."""
    master = enabled(Rig(changes=SHORT_STOP), CSP)
    rig = master.rig
    rig.simulation.tune('supply', {'pressure_mpa': 1.0})
    master.cycle_until(is_in('FAULT_REACTION', 'FAULT'), ENABLE)
    for _ in range(ticks):
        master.cycle(ENABLE)
    master.device.restart(is_whole=True)
    rig.tick()
    rig.tick()
    assert rig.sample['device_state'] == FAULT      # its cause is there
    rig.simulation.tune('supply', {'pressure_mpa': 20.7})
    for _ in range(60):
        rig.tick()
    assert state(master.upload(0x6041)) == 'FAULT'
    master.device.restart(is_whole=True)
    for _ in range(3):
        rig.tick()
    assert (state(master.upload(0x6041)), master.upload(0x603F)) == ('SWITCH_ON_DISABLED', 0)
    assert rig.sample['device_state'] == OFF


def test_a_valve_that_was_active_holds_until_m_has_fallen():
    master = Master(Rig(profile='cia408'))
    master.outputs[0x6043, 0] = 9
    master.outputs[0x6600, 1] = master.upload(0x6601, 1)
    for _ in range(6):
        word = master.cycle(ACTIVE)
    assert word & 0xF == R | ACTIVE
    master.device.end_operation(is_lost=False)
    master.rig.tick()       # others keep the bus going: this does not count as M falling
    master.device.begin_operation()
    for _ in range(3):
        assert master.cycle(ACTIVE) & 0xF == R | HOLD
    master.cycle(HOLD)
    assert master.cycle(ACTIVE) & 0xF == R | ACTIVE
    master.device.end_operation(is_lost=False)
    master.device.restart(is_whole=False)
    assert master.upload(0x6041) & 0xF == R | INIT
    master.device.begin_operation()
    for _ in range(300):
        word = master.cycle(ACTIVE)
    assert (word & 0xF, master.rig.sample['device_state']) == (R | DISABLED, OFF)
    master.cycle(DISABLED)
    assert [master.cycle(ACTIVE) & 0xF for _ in range(2)] == [R | HOLD, R | ACTIVE]


# On the buses.

@pytest.mark.parametrize(('command', 'shown'), [
    (NMT_STOP, 'QUICK_STOP'), (TO_PREOPERATIONAL, 'QUICK_STOP'),
    (RESET_COMMUNICATION, 'SWITCH_ON_DISABLED'), (RESET_NODE, 'SWITCH_ON_DISABLED')])
def test_commands_of_the_nmt_master_stop_the_drive(command, shown):
    master = moving()
    with virtual_master([master.device], STEP_NS) as canopen:
        canopen.command(START)
        canopen.command(command)
        assert state(master.upload(0x6041)) == shown
        canopen.command(START)
        assert state(master.upload(0x6041)) == shown


@pytest.mark.parametrize(('lowest', 'shown'), [
    (SAFEOP, 'QUICK_STOP'), (PREOP, 'QUICK_STOP'), (AL_INIT, 'SWITCH_ON_DISABLED')])
def test_ethercat_states_below_operational_stop_the_drive(lowest, shown):
    master = moving()
    ring = RawMaster(master.device)
    ring.bring_up()
    ring.request(lowest)
    assert state(master.upload(0x6041)) == shown
    ring.bring_up() if lowest == AL_INIT else [
        ring.request(one) for one in (PREOP, SAFEOP, OP) if one > lowest]
    assert ring.number(0x0130) == OP
    assert state(master.upload(0x6041)) == shown


def test_an_assignment_does_not_outlive_init():
    rig = Rig()
    master = Master(rig)
    ring = RawMaster(rig.device)
    rig.device.end_operation(is_lost=False)
    for index, value in ((0, 0), (1, 0x1600), (2, 0x1601), (0, 2)):
        master.download(0x1C12, index, value, is_preoperational=True)
    master.download(0x1600, 0, 2, is_preoperational=True)
    assert (rig.device.assigned(0x1C12), rig.device.size(0x1600)) == ([0x1600, 0x1601], 3)
    ring.configure_mailboxes()
    ring.request(PREOP)
    ring.request(AL_INIT)
    assert (rig.device.assigned(0x1C12), rig.device.size(0x1600)) == ([0x1610], 5)


def test_a_drive_without_a_sample_is_not_ready_after_a_restart():
    device, = devices_of(Rig().simulation.scenario.run)
    device.restart(is_whole=True)
    assert int.from_bytes(device.read(0x6041, 0), 'little') & 0x6F == State402.NOT_READY.bits
