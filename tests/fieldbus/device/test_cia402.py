"""A CiA 402 drive in front of a real actuator: its states, options and limits."""

from isa_ros.fieldbus.device.abort import INCOMPATIBLE, SdoAbort
from isa_ros.fieldbus.device.cia402_states import Event402, State402, TRANSITIONS
from isa_ros.fieldbus.device.devices import devices_of
import pytest

from ..master_402 import (
    CST, ENABLE, enabled, is_in, RESET, SHUTDOWN, state, STOP, SWITCH_ON, VOLTAGE_OFF)
from ..rig import Master, Rig


def test_before_the_first_sample_the_drive_is_not_ready(rig):
    device, = devices_of(rig.simulation.scenario.run)
    assert state(int.from_bytes(device.read(0x6041, 0), 'little')) == 'NOT_READY'


def test_time_is_wanted_from_the_first_control_word_on(rig):
    master = Master(rig)
    master.cycle(0)
    assert not rig.device.is_wanted
    master.cycle(SHUTDOWN)
    assert rig.device.is_wanted
    master.cycle(0)
    assert rig.device.is_wanted


def test_the_end_of_operation_does_not_begin_time(rig):
    rig.device.end_operation(is_lost=False)
    Master(rig).download(0x6066, 0, 1)
    assert not rig.device.is_wanted


def test_a_control_word_by_sdo_counts_as_well(rig):
    Master(rig).download(0x6040, 0, SHUTDOWN)
    assert rig.device.is_wanted


@pytest.mark.parametrize(('words', 'states'), [
    ((SHUTDOWN, SWITCH_ON, ENABLE), ('READY', 'SWITCHED_ON', 'OPERATION_ENABLED')),
    ((SHUTDOWN, ENABLE, ENABLE), ('READY', 'SWITCHED_ON', 'OPERATION_ENABLED')),
    ((SHUTDOWN, VOLTAGE_OFF), ('READY', 'SWITCH_ON_DISABLED')),
    ((SHUTDOWN, STOP), ('READY', 'SWITCH_ON_DISABLED')),
    ((SHUTDOWN, SWITCH_ON, SHUTDOWN), ('READY', 'SWITCHED_ON', 'READY')),
    ((SHUTDOWN, SWITCH_ON, VOLTAGE_OFF), ('READY', 'SWITCHED_ON', 'SWITCH_ON_DISABLED')),
    ((SHUTDOWN, SWITCH_ON, STOP), ('READY', 'SWITCHED_ON', 'SWITCH_ON_DISABLED')),
    ((SHUTDOWN, SWITCH_ON, ENABLE, SWITCH_ON),
     ('READY', 'SWITCHED_ON', 'OPERATION_ENABLED', 'SWITCHED_ON')),
    ((SHUTDOWN, SWITCH_ON, ENABLE, SHUTDOWN),
     ('READY', 'SWITCHED_ON', 'OPERATION_ENABLED', 'READY')),
    ((SHUTDOWN, SWITCH_ON, ENABLE, VOLTAGE_OFF),
     ('READY', 'SWITCHED_ON', 'OPERATION_ENABLED', 'SWITCH_ON_DISABLED')),
    ((SHUTDOWN, SWITCH_ON, ENABLE, STOP),
     ('READY', 'SWITCHED_ON', 'OPERATION_ENABLED', 'QUICK_STOP')),
    ((SHUTDOWN, SWITCH_ON, ENABLE, STOP, VOLTAGE_OFF),
     ('READY', 'SWITCHED_ON', 'OPERATION_ENABLED', 'QUICK_STOP', 'SWITCH_ON_DISABLED')),
    ((SWITCH_ON, ENABLE), ('SWITCH_ON_DISABLED', 'SWITCH_ON_DISABLED')),
    ((SHUTDOWN, RESET | SWITCH_ON), ('READY', 'READY')),
])
def test_control_words_lead_through_the_states(rig, words, states):
    master = Master(rig)
    assert state(master.cycle(VOLTAGE_OFF)) == 'SWITCH_ON_DISABLED'
    assert tuple(state(master.cycle(word)) for word in words) == states
    is_on = states[-1] == 'OPERATION_ENABLED' or states[-1] == 'QUICK_STOP'
    master.cycle(words[-1])
    assert (rig.sample['device_state'] in (2, 3)) == is_on


def test_a_quick_stop_ends_switched_on_disabled_by_option_2(rig):
    master = enabled(rig)
    assert state(master.cycle(STOP)) == 'QUICK_STOP'
    assert state(master.cycle(ENABLE)) == 'QUICK_STOP'
    master.cycle_until(is_in('SWITCH_ON_DISABLED'), ENABLE)
    assert rig.sample['device_state'] == 1
    assert rig.simulation.ticks >= 200  # `quick_stop_hold_ms` of the sheet


def test_a_quick_stop_stays_by_option_6_and_operation_goes_on(rig):
    master = enabled(rig)
    master.download(0x605A, 0, 6)
    master.cycle(STOP)
    for _ in range(300):
        assert state(master.cycle(STOP)) == 'QUICK_STOP'
    assert rig.sample['device_state'] == 2
    held = rig.sample['position']
    for _ in range(1000):
        assert state(master.cycle(STOP)) == 'QUICK_STOP'
    # With the valve at null the lands leak, and 50 kg sink by 70 um in this second.
    assert rig.sample['position'] == pytest.approx(held, abs=20e-6)
    assert state(master.cycle(ENABLE)) == 'OPERATION_ENABLED'
    master.cycle(ENABLE)
    assert rig.sample['device_state'] == 2


@pytest.mark.parametrize(('kind', 'code', 'reached'), [
    ('close', 0, 'SWITCH_ON_DISABLED'), ('ramp', 2, 'SWITCH_ON_DISABLED'),
    ('ramp_and_hold', 6, 'QUICK_STOP')])
def test_the_option_code_begins_with_the_quick_stop_of_the_reu(kind, code, reached):
    """With the one that holds, the REU bears its load until the master disables it."""
    rig = Rig(changes={'actuators.ram.parameters.reu.device.quick_stop': kind})
    master = enabled(rig)
    assert master.upload(0x605A) == code
    for _ in range(250):
        word = master.cycle(STOP)
    assert state(word) == reached
    assert rig.sample['device_state'] == (3 if code == 6 else 1)
    assert state(master.cycle(VOLTAGE_OFF)) == 'SWITCH_ON_DISABLED'


def test_a_quick_stop_is_off_at_once_by_option_0(rig):
    master = enabled(rig)
    master.download(0x605A, 0, 0)
    assert state(master.cycle(STOP)) == 'SWITCH_ON_DISABLED'
    assert rig.sample['device_state'] == 1


def test_what_is_disabled_or_stopped_from_elsewhere_is_followed(rig):
    master = enabled(rig)
    rig.simulation.command('ram', is_enabled=False)
    rig.commands['kinds'] = 0
    rig.simulation.step(rig.commands)
    rig.device.take_sample(rig.sample, rig.simulation.ticks)
    assert state(master.upload(0x6041)) == 'SWITCH_ON_DISABLED'
    other = enabled(Rig())
    other.rig.simulation.command('ram', quick_stop=True)
    assert state(other.cycle(ENABLE)) == 'QUICK_STOP'


def test_every_transition_has_a_row_and_every_state_a_way_out():
    assert {row.number for row in TRANSITIONS} == set(range(1, 17))
    assert {row.state for row in TRANSITIONS} == set(State402)
    assert {row.event for row in TRANSITIONS} == set(Event402)


def test_targets_beyond_the_limits_are_limited_and_say_so(rig):
    master = enabled(rig)
    assert not master.cycle(ENABLE) & 1 << 11
    assert master.cycle(ENABLE, x607A=100001) & 1 << 11
    assert rig.simulation.applied[0]['position'] == 0.1
    master.download(0x607D, 2, 60000)
    assert master.cycle(ENABLE, x607A=60001) & 1 << 11
    assert rig.simulation.applied[0]['position'] == 0.06
    assert not master.cycle(ENABLE, x607A=60000) & 1 << 11


def test_limits_that_cross_are_refused(rig):
    master = Master(rig)
    master.download(0x607D, 2, 60000)
    with pytest.raises(SdoAbort) as refused:
        master.download(0x607D, 1, 60001)
    assert refused.value.code == INCOMPATIBLE


def test_forces_are_limited_to_max_torque_and_to_the_rated_ones(rig):
    master = enabled(rig, CST)
    assert master.cycle(ENABLE, x6071=-1000) & 1 << 11
    assert rig.simulation.applied[0]['effort'] == -5174.0
    master.download(0x6072, 0, 100)
    master.cycle(ENABLE, x6071=-1000)
    assert rig.simulation.applied[0]['effort'] == -750.0


def test_a_drive_on_the_four_pdos_of_canopen_is_the_same(rig):
    master = Master(rig, (0x1600, 0x1A00))
    for control in (SHUTDOWN, SWITCH_ON, ENABLE, ENABLE):
        word = master.cycle(control, x6060=CST, x6071=50)
    assert state(word) == 'OPERATION_ENABLED'
    assert rig.simulation.applied[0]['effort'] == 375.0


def test_an_actuator_that_enables_itself_is_disabled_at_the_first_tick(rig):
    assert rig.simulation.scenario.run.actuators[0].auto_enable
    Master(rig).cycle(SHUTDOWN)
    assert rig.sample['device_state'] == 1
