"""Faults of a CiA 402 drive in front of a real actuator: trips, lost bus, following error."""

from isa_ros.core.conditions import BITS, CONDITIONS
from isa_ros.fieldbus.device.abort import OUT_OF_RANGE, SdoAbort
from isa_ros.fieldbus.device.faults import BUS_LOST, FOLLOWING_ERROR
import numpy as np
import pytest

from .master_402 import (
    CSV, ENABLE, enabled, IMPEDANCE, is_in, POSITION, RESET, SHUTDOWN, state, SWITCH_ON,
    VOLTAGE_OFF)
from .rig import Master, Rig, without_supply

LATE = 1 << 13


def test_a_following_error_beyond_window_and_time_is_a_fault(rig):
    master = enabled(rig)
    master.download(0x6065, 0, 20000)
    master.download(0x6066, 0, 5)
    target = 100000 if master.inputs[POSITION] < 50000 else 0
    word = master.cycle(ENABLE, x607A=target)
    assert not word & LATE and state(word) == 'OPERATION_ENABLED'
    word = master.cycle_until(is_in('FAULT_REACTION'), ENABLE, most=5)
    assert word & LATE
    late = master.upload(0x60F4)
    assert late == target - master.inputs[POSITION]
    word = master.cycle_until(is_in('FAULT'), ENABLE)
    assert word & LATE and master.upload(0x60F4) == late
    assert not master.cycle(RESET) & LATE
    assert master.upload(0x60F4) == 0
    master.cycle(0)
    for control in (SHUTDOWN, SWITCH_ON, ENABLE, *[ENABLE] * 5):
        word = master.cycle(control, x607A=master.inputs[POSITION])
    assert state(word) == 'OPERATION_ENABLED' and not word & LATE
    rig.emergencies[1:] = []
    master.cycle(ENABLE, x607A=target)
    master.cycle_until(is_in('FAULT'), ENABLE)
    assert master.upload(0x603F) == FOLLOWING_ERROR.code
    assert rig.emergencies[0].code == FOLLOWING_ERROR.code


@pytest.mark.parametrize('timeout_ms', [0, 1, 5, 20, 21])
def test_a_following_error_is_a_fault_after_its_time_in_whole_ticks(rig, timeout_ms):
    """Longer than the time: n ms are over at tick n + 1, whatever n times 0.001 s rounds to."""
    master = enabled(rig)
    master.download(0x6065, 0, 20000)
    master.download(0x6066, 0, timeout_ms)
    target = 100000 if master.inputs[POSITION] < 50000 else 0
    states = [state(master.cycle(ENABLE, x607A=target)) for _ in range(timeout_ms + 2)]
    assert states.index('FAULT_REACTION') == timeout_ms + 1 - 1


def test_the_time_of_a_following_error_begins_anew_after_the_window(rig):
    master = enabled(rig)
    master.download(0x6065, 0, 20000)
    master.download(0x6066, 0, 5)
    near = master.inputs[POSITION]
    far = 100000 if near < 50000 else 0
    for _ in range(3):
        for target in (*[far] * 4, near):
            word = master.cycle(ENABLE, x607A=target)
    assert state(word) == 'OPERATION_ENABLED' and not word & LATE


def test_a_following_error_is_not_watched_without_a_window_or_in_other_modes(rig):
    master = enabled(rig)
    target = 100000 if master.inputs[POSITION] < 50000 else 0
    for _ in range(10):
        word = master.cycle(ENABLE, x607A=target)
    assert state(word) == 'OPERATION_ENABLED'
    master.cycle(ENABLE, x6060=IMPEDANCE)
    master.download(0x6065, 0, 10)
    for _ in range(10):
        word = master.cycle(ENABLE, x607A=target)
    assert state(word) == 'OPERATION_ENABLED'


TRIPS = {
    'setpoint_timeout': {'setpoint_timeout_ms': 2.0, 'setpoint_timeout_reaction': 'disable'},
    'overspeed': {'warning': 0.0, 'trip': 1e-6, 'delay_ms': 0.0, 'reaction': 'disable'},
    'overload': {'warning': 0.0, 'trip': 1e-6, 'delay_ms': 0.0},
    'overpressure': {'warning': 0.0, 'trip': 0.01, 'delay_ms': 0.0},
    'overcurrent': {'warning': 0.0, 'trip': 1e-6, 'delay_ms': 0.0},
    'overtemperature': {'warning': 0.0, 'trip': 1.0, 'delay_ms': 0.0},
    'supply_low': {'warning': 0.0, 'trip': 1.0, 'delay_ms': 0.0},
    'relief_open': {'warning': 0.0, 'trip': 0.01, 'delay_ms': 0.0, 'reaction': 'disable'},
    'load_cell_implausible': {'warning': 0.0, 'trip': 0.1, 'delay_ms': 0.0},
    'encoder_jump': {'warning': 0.0, 'trip': 1e-6, 'delay_ms': 0.0},
    'spool_deviation': {'warning': 0.0, 'trip': 1e-5, 'delay_ms': 0.0}}
"""Levels that are met while the actuator moves, by condition."""


def tripping(condition):
    """Return a rig whose device trips by a condition; others do not stop it."""
    prefix = 'actuators.ram.parameters.reu.protection'
    section = TRIPS[condition]
    if condition == 'setpoint_timeout':
        return Rig(changes={f'{prefix}.{key}': value for key, value in section.items()})
    return Rig(changes={f'{prefix}.{condition}': section})


@pytest.mark.parametrize('condition', TRIPS)
def test_a_trip_of_the_device_is_a_fault_with_its_code(condition):
    rig = tripping(condition)
    if condition == 'load_cell_implausible':
        rig.simulation.tune('ram', {'plant.sensors.force.bias': 3000.0})
    master = Master(rig)
    for k, control in enumerate((SHUTDOWN, SWITCH_ON, ENABLE, ENABLE, *[ENABLE] * 100)):
        if state(master.cycle(control, x6060=CSV, x60FF=50000)) == 'FAULT':
            break
        if condition == 'setpoint_timeout' and k > 5:
            rig.simulation.step(np.zeros(1, rig.commands.dtype))
            rig.simulation.step(np.zeros(1, rig.commands.dtype))
    own = CONDITIONS[BITS[condition]].error
    assert state(master.upload(0x6041)) == 'FAULT'
    assert master.upload(0x603F) == own.code
    assert master.upload(0x1001) & (own.register | 1) == own.register | 1
    assert own.code in [one.code for one in rig.emergencies]
    assert master.upload(0x1003, 1) & 0xFFFF == own.code
    first = next(one for one in rig.emergencies if one.code == own.code)
    assert int.from_bytes(first.data, 'little') >> BITS[condition] & 1
    assert rig.sample['device_state'] == 5


def faulted():
    """Return a master whose actuator has lost its supply while enabled."""
    rig = Rig()
    master = enabled(rig)
    without_supply(rig, True)
    master.cycle_until(is_in('FAULT'), ENABLE)
    return master


def test_a_fault_is_reset_by_a_rising_edge_once_its_cause_is_gone():
    master = faulted()
    code = CONDITIONS[BITS['supply_low']].error.code
    assert master.upload(0x603F) == code
    assert master.upload(0x2024, 5) == 1e6
    for word in (VOLTAGE_OFF, RESET, RESET):
        assert state(master.cycle(word)) == 'FAULT'
    without_supply(master.rig, False)
    for word in (RESET, *[RESET] * 50, VOLTAGE_OFF):
        assert state(master.cycle(word)) == 'FAULT'
    master.cycle_until(is_in('SWITCH_ON_DISABLED'), RESET, most=2)
    assert (master.upload(0x603F), master.upload(0x1001)) == (0, 0)
    assert [one.code for one in master.rig.emergencies] == [code, 0]
    assert master.upload(0x1003) == 1
    for control in (SHUTDOWN, SWITCH_ON, ENABLE, ENABLE):
        word = master.cycle(control)
    assert state(word) == 'OPERATION_ENABLED'


def test_the_error_field_is_deleted_by_writing_0():
    master = faulted()
    assert master.upload(0x1003) == 1
    with pytest.raises(SdoAbort) as refused:
        master.download(0x1003, 0, 1)
    assert refused.value.code == OUT_OF_RANGE
    master.download(0x1003, 0, 0)
    assert master.upload(0x1003, 0) == master.upload(0x1003, 1) == 0


def test_supply_and_warnings_show_in_the_status_word():
    rig = Rig()
    master = enabled(rig)
    assert master.cycle(ENABLE) & (1 << 4 | 1 << 7) == 1 << 4
    rig.simulation.tune('supply', {'pressure_mpa': 10.0})
    word = master.cycle_until(lambda word: bool(word & 1 << 7), ENABLE)
    assert not word & 1 << 4
    assert master.upload(0x2025, 1) == 1 << BITS['supply_low']


def test_a_lost_bus_stops_the_actuator_and_is_a_fault_until_it_is_reset():
    rig = Rig()
    master = enabled(rig)
    rig.device.end_operation(is_lost=True)
    assert state(master.upload(0x6041)) == 'FAULT_REACTION'
    rig.tick()
    assert rig.sample['device_state'] == 3
    for _ in range(300):
        rig.tick()
    assert rig.sample['device_state'] == 1
    assert state(master.upload(0x6041)) == 'FAULT'
    assert master.upload(0x603F) == BUS_LOST.code == 0x8180
    assert not master.upload(0x6041) & 1 << 9
    rig.device.begin_operation()
    assert state(master.cycle(ENABLE)) == 'FAULT'
    assert state(master.cycle(RESET)) == 'SWITCH_ON_DISABLED'
    assert [one.code for one in rig.emergencies] == [BUS_LOST.code, 0]
    assert master.upload(0x603F) == 0


def test_a_bus_that_is_lost_while_disabled_is_a_fault_at_once(rig):
    master = Master(rig)
    master.cycle(SHUTDOWN)
    rig.device.end_operation(is_lost=True)
    assert state(master.upload(0x6041)) == 'FAULT'


def test_a_bus_that_is_left_on_purpose_stops_without_a_fault(rig):
    master = enabled(rig)
    rig.device.end_operation(is_lost=False)
    rig.tick()
    assert state(master.upload(0x6041)) == 'QUICK_STOP'
    assert rig.sample['device_state'] == 3
    for _ in range(300):
        rig.tick()
    assert state(master.upload(0x6041)) == 'SWITCH_ON_DISABLED'
    assert not rig.emergencies


def test_process_data_that_are_too_short_are_reported_and_not_used(rig):
    master = Master(rig)
    master.cycle(SHUTDOWN)
    rig.device.receive(0x1610, b'\0' * 5)
    rig.tick()
    assert state(master.upload(0x6041)) == 'READY'
    assert [one.code for one in rig.emergencies] == [0x8210]
