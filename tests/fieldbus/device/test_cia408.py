"""A CiA 408 device in front of a real actuator: states, control modes, scaling, faults."""

from isa_ros.core.conditions import BITS, CONDITIONS
from isa_ros.fieldbus.device.abort import OUT_OF_RANGE, SdoAbort
from isa_ros.fieldbus.device.cia408_states import Event408, State408, TRANSITIONS
from isa_ros.fieldbus.device.devices import devices_of
from isa_ros.fieldbus.device.faults import BUS_LOST
import pytest

from ..rig import Master, Rig, without_supply

INIT, DISABLED, HOLD, ACTIVE, RESET = 0b0000, 0b0001, 0b0011, 0b0111, 0b1000
OPEN_LOOP, CLOSED_LOOP, PQ, AXIS_VELOCITY, AXIS_POSITION = 1, 2, 5, 7, 9
NAMES = {0b1000: 'INIT', 0b1001: 'DISABLED', 0b1011: 'HOLD', 0b1111: 'ACTIVE',
         0b0001: 'FAULT_DISABLED', 0b0011: 'FAULT_HOLD', 0b0111: 'FAULT_REACTION'}
"""States by the bits R, M, H, D; 0 is FAULT_INIT, or not ready."""
SPOOL, PRESSURE, VELOCITY, POSITION = (0x6300, 1), (0x6380, 1), (0x6500, 1), (0x6600, 1)
PRESSURE_CONTROL = {'actuators.rotor.variants': ['pressure_control']}


def state(word):
    return NAMES.get(word & 0xF, 'FAULT_INIT')


def rig_of(config='rig_linear', changes=None):
    return Rig(config, 'cia408', changes)


def active(rig, mode=AXIS_POSITION, **setpoints):
    """Return a master whose device is active at the present position."""
    master = Master(rig)
    master.outputs[POSITION] = master.upload(0x6601, 1)
    master.outputs.update(setpoints)
    for word in (DISABLED, HOLD, ACTIVE):
        reached = master.cycle(word, x6043=mode)
    assert state(reached) == 'ACTIVE'
    return master


@pytest.fixture
def rig():
    return rig_of()


def test_before_the_first_sample_the_device_is_not_ready(rig):
    device, = devices_of(rig.simulation.scenario.run, 'cia408')
    assert device.read(0x6041, 0) == b'\0\0'
    device.take_sample(rig.sample, 0)
    assert device.read(0x6041, 0) == b'\10\0'


@pytest.mark.parametrize(('words', 'states'), [
    ((INIT,), ('INIT',)),
    ((DISABLED, INIT), ('DISABLED', 'INIT')),
    ((ACTIVE, ACTIVE, ACTIVE), ('DISABLED', 'HOLD', 'ACTIVE')),
    ((HOLD, HOLD, HOLD), ('DISABLED', 'HOLD', 'HOLD')),
    ((ACTIVE, ACTIVE, ACTIVE, HOLD, DISABLED, INIT),
     ('DISABLED', 'HOLD', 'ACTIVE', 'HOLD', 'DISABLED', 'INIT')),
    ((ACTIVE, ACTIVE, ACTIVE, INIT, INIT, INIT),
     ('DISABLED', 'HOLD', 'ACTIVE', 'HOLD', 'DISABLED', 'INIT')),
    ((0b0110,), ('INIT',)), ((0b0101, 0b0101), ('DISABLED', 'DISABLED'))])
def test_control_words_lead_through_the_states(rig, words, states):
    master = Master(rig)
    assert tuple(state(master.cycle(word)) for word in words) == states
    assert (rig.sample['device_state'] == 2) == (states[-1] in ('HOLD', 'ACTIVE'))


def test_every_state_and_event_is_in_the_table():
    assert {row.state for row in TRANSITIONS} == set(State408)
    assert {row.event for row in TRANSITIONS} == set(Event408)
    assert {row.number for row in TRANSITIONS} == {'', *map(str, range(1, 17))}


# Control modes.

def test_axis_position_follows_the_setpoint_and_hold_keeps_the_position(rig):
    master = active(rig)
    start = master.upload(0x6610, 1)
    for k in range(500):
        master.outputs[POSITION] = start + 20 * k
        master.cycle(ACTIVE)
    assert master.upload(0x6610, 1) == start + 9980
    assert master.inputs[0x6601, 1] == round(rig.sample['position'] * 1e6)
    master.cycle(HOLD)
    held = master.upload(0x6610, 1)
    master.outputs[POSITION] = 0
    for _ in range(50):
        master.cycle(HOLD)
    assert master.upload(0x6610, 1) == held
    assert abs(held - master.inputs[0x6601, 1]) < 6000  # 490 N of 1e5 N/m


def test_axis_velocity_integrates_the_setpoint(rig):
    master = active(rig, AXIS_VELOCITY)
    start = master.upload(0x6610, 1)
    master.outputs[VELOCITY] = 50000
    for _ in range(300):
        master.cycle(ACTIVE)
    assert master.upload(0x6610, 1) - start == pytest.approx(300 * 50, abs=1)
    # The friction of the seals is the only load along the reference: it lags, but as fast.
    assert master.inputs[0x6501, 1] == pytest.approx(50000, rel=0.15)


def test_the_spool_is_controlled_in_16384ths_of_its_stop(rig):
    master = active(rig, CLOSED_LOOP)
    stop = master.upload(0x2000, 4) * 16384
    master.outputs[SPOOL] = 4096
    for _ in range(20):
        master.cycle(ACTIVE)
    assert rig.sample['device_mode'] == 2
    assert rig.sample['spool_reference'] == pytest.approx(stop / 4, rel=1e-6)
    assert master.inputs[0x6301, 1] == pytest.approx(4096, rel=0.1)
    assert rig.sample['velocity'] > 0.0
    master.cycle(HOLD)
    assert rig.sample['spool_reference'] == 0.0


def test_the_hold_setpoint_of_the_spool_is_an_object(rig):
    master = active(rig, CLOSED_LOOP)
    master.download(0x6314, 1, 1024)
    master.cycle(HOLD)
    stop = master.upload(0x2000, 4) * 16384
    assert rig.sample['spool_reference'] == pytest.approx(stop / 16, rel=1e-6)


def test_without_a_spool_sensor_the_spool_is_controlled_open_loop():
    rig = rig_of('rig_rotary')
    master = active(rig, OPEN_LOOP)
    master.outputs[SPOOL] = -2048
    for _ in range(20):
        master.cycle(ACTIVE)
    assert rig.sample['device_mode'] == 1
    assert rig.sample['spool'] < 0.0
    with pytest.raises(SdoAbort) as refused:
        master.download(0x6043, 0, CLOSED_LOOP)
    assert refused.value.code == OUT_OF_RANGE
    master.cycle(ACTIVE, x6043=CLOSED_LOOP)
    assert master.inputs[0x6043, 0] == OPEN_LOOP
    assert master.upload(0x2003) == 'control mode 2 does not exist here; there are 1, 7, 9'


def test_the_pressure_difference_is_controlled_where_there_is_a_pressure_block():
    rig = rig_of('rig_rotary', PRESSURE_CONTROL)
    master = active(rig, PQ)
    master.outputs[PRESSURE] = 655
    for _ in range(300):
        word = master.cycle(ACTIVE)
    assert word & 1 << 8
    assert rig.sample['device_mode'] == 3
    wanted = 655 * master.upload(0x2000, 5)
    measured = rig.sample['pressure_a'] - rig.sample['pressure_b']
    assert measured == pytest.approx(wanted, rel=0.2)
    assert master.inputs[0x6381, 1] == round(measured / 25e6 * 16384)


def test_a_setpoint_beyond_its_range_is_limited_and_says_so(rig):
    master = active(rig)
    assert not master.cycle(ACTIVE) & 1 << 10
    master.outputs[POSITION] = 100001
    assert master.cycle(ACTIVE) & 1 << 10
    assert rig.simulation.applied[0]['position'] == 0.1
    master.cycle(ACTIVE, x6043=CLOSED_LOOP)
    master.outputs[SPOOL] = 20000
    assert master.cycle(ACTIVE) & 1 << 10


# Faults.

@pytest.mark.parametrize(('word', 'fault', 'after'), [
    (INIT, 'FAULT_INIT', 'INIT'), (DISABLED, 'FAULT_DISABLED', 'DISABLED'),
    (ACTIVE, 'FAULT_DISABLED', 'DISABLED')])
def test_a_fault_of_the_device_disables_it_until_it_is_reset(rig, word, fault, after):
    master = Master(rig)
    for _ in range(3):
        master.cycle(word)
    without_supply(rig, True)
    master.cycle_until(lambda shown: state(shown) == fault, word & DISABLED, most=100)
    code = CONDITIONS[BITS['supply_low']].error.code
    assert master.upload(0x603F) == code
    assert state(master.cycle(word & DISABLED | RESET)) == fault
    without_supply(rig, False)
    for _ in range(50):
        assert state(master.cycle(word & DISABLED)) == fault
    shown = [state(master.cycle(word & DISABLED | RESET)) for _ in range(3)]
    assert shown[-1] == after
    assert master.upload(0x603F) == 0
    assert [one.code for one in rig.emergencies] == [code, 0]


def test_a_fault_with_a_reaction_shows_it():
    prefix = 'actuators.ram.parameters.reu.protection.overtemperature'
    rig = rig_of(changes={prefix: {
        'warning': 0.0, 'trip': 1.0, 'delay_ms': 4.0, 'reaction': 'quick_stop'}})
    master = Master(rig)
    seen = [state(master.cycle(ACTIVE)) for _ in range(400)]
    assert [one for k, one in enumerate(seen) if k == 0 or one != seen[k - 1]][-2:] == [
        'FAULT_REACTION', 'FAULT_DISABLED']
    assert seen.count('FAULT_REACTION') >= 200  # `quick_stop_hold_ms`


def test_a_lost_bus_holds_the_axis_and_is_a_fault_until_it_is_reset(rig):
    master = active(rig)
    rig.device.end_operation(is_lost=True)
    assert state(master.upload(0x6041)) == 'FAULT_REACTION'
    position = master.upload(0x6601, 1)
    for _ in range(100):
        rig.tick()
    assert state(master.upload(0x6041)) == 'FAULT_HOLD'
    assert rig.sample['device_state'] == 2
    assert abs(master.upload(0x6601, 1) - position) < 6000  # 490 N of 1e5 N/m
    assert master.upload(0x603F) == BUS_LOST.code
    assert state(master.cycle(ACTIVE)) == 'FAULT_HOLD'
    assert state(master.cycle(ACTIVE | RESET)) == 'HOLD'
    assert state(master.cycle(ACTIVE)) == 'ACTIVE'


def test_a_fault_that_holds_is_left_downwards(rig):
    master = active(rig)
    rig.device.end_operation(is_lost=True)
    for _ in range(3):
        rig.tick()
    assert state(master.cycle(DISABLED)) == 'FAULT_DISABLED'
    assert rig.sample['device_state'] == 1
    assert state(master.cycle(INIT)) == 'FAULT_INIT'
    assert state(master.cycle(RESET)) == 'INIT'


def test_a_trip_while_a_fault_holds_disables(rig):
    master = active(rig)
    rig.device.end_operation(is_lost=True)
    for _ in range(3):
        rig.tick()
    without_supply(rig, True)
    master.cycle_until(lambda word: state(word) == 'FAULT_DISABLED', HOLD, most=100)
    assert rig.sample['device_state'] == 5


def test_a_bus_that_is_left_on_purpose_holds_without_a_fault(rig):
    master = active(rig)
    rig.device.end_operation(is_lost=False)
    for _ in range(3):
        rig.tick()
    assert state(master.upload(0x6041)) == 'HOLD'
    assert not rig.emergencies


def test_what_is_disabled_from_elsewhere_stays_so_until_h_falls(rig):
    master = active(rig)
    rig.simulation.command('ram', is_enabled=False)
    rig.commands['kinds'] = 0
    rig.simulation.step(rig.commands)
    rig.device.take_sample(rig.sample, rig.simulation.ticks)
    for _ in range(5):
        assert state(master.cycle(ACTIVE)) == 'DISABLED'
    master.cycle(DISABLED)
    assert [state(master.cycle(ACTIVE)) for _ in range(2)] == ['HOLD', 'ACTIVE']


def test_a_lost_bus_enables_nothing_that_was_disabled(rig):
    """Its reaction holds what is held: outputs that are off stay off."""
    master = Master(rig)
    for word in (DISABLED, DISABLED):
        master.cycle(word)
    rig.device.end_operation(is_lost=True)
    for _ in range(5):
        rig.tick()
        assert rig.sample['device_state'] == 1
    assert state(master.upload(0x6041)) == 'FAULT_DISABLED'


def test_a_bus_that_is_lost_while_the_reu_initialises_leaves_it_disabled():
    """It was to be enabled once it is ready; nobody commands it then."""
    rig = rig_of(changes={'actuators.ram.parameters.reu.device.initialisation_ms': 20.0})
    master = Master(rig)
    for word in (DISABLED, HOLD, HOLD):
        master.cycle(word)
    rig.device.end_operation(is_lost=True)
    for _ in range(40):
        rig.tick()
    assert rig.sample['device_state'] == 1
