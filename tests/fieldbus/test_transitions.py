"""A master takes a real actuator through every transition of both profiles."""

import isa_ros
from isa_ros.fieldbus.device import cia402_states
from isa_ros.fieldbus.device import cia408_states
from isa_ros.fieldbus.device.cia402 import Drive402
from isa_ros.fieldbus.device.cia408 import Drive408
from isa_ros.fieldbus.device.devices import devices_of
import pytest

from .rig import Master, Rig

SHUTDOWN, SWITCH_ON, ENABLE, STOP, VOLTAGE_OFF, RESET = 0x06, 0x07, 0x0F, 0x02, 0x00, 0x80
INIT, DISABLED, HOLD, ACTIVE, R = 0b0000, 0b0001, 0b0011, 0b0111, 0b1000
SHORT_STOP = {'actuators.ram.parameters.reu.device.quick_stop_hold_ms': 5.0}
TO_402 = {'SWITCH_ON_DISABLED': (), 'READY': (SHUTDOWN,), 'SWITCHED_ON': (SHUTDOWN, SWITCH_ON),
          'OPERATION_ENABLED': (SHUTDOWN, SWITCH_ON, ENABLE),
          'QUICK_STOP': (SHUTDOWN, SWITCH_ON, ENABLE, ENABLE, STOP)}
TO_408 = {'INIT': (), 'DISABLED': (DISABLED,), 'HOLD': (HOLD, HOLD),
          'ACTIVE': (ACTIVE, ACTIVE, ACTIVE)}


def seen_by(monkeypatch, drive):
    """Return a set that gets state and event of each change of a drive, and where it led."""
    happens, seen = drive._happens, set()

    def watched(self, event):
        before = self.state
        happens(self, event)
        if self.state is not before:
            seen.add((before, event, self.state))
    monkeypatch.setattr(drive, '_happens', watched)
    return seen


def rows(states):
    return {(row.state, row.event, row.following) for row in states.TRANSITIONS}


def master_at(words, profile='cia402', mode=8):
    """Return a master that has sent control words, and waits in place."""
    rig = Rig('rig_linear', profile, SHORT_STOP)
    master = Master(rig)
    index = 0x6060 if profile == 'cia402' else 0x6043
    master.outputs[index, 0] = mode
    if profile == 'cia402':
        master.outputs[0x607A, 0] = master.upload(0x6064)
    master.cycle(0)
    for word in words:
        master.cycle(word)
    return master


def lost(master, after=(), count=30):
    """Lose the bus, let ticks pass, and send control words."""
    master.device.end_operation(is_lost=True)
    for _ in range(count):
        master.rig.tick()
    for word in after:
        master.cycle(word)


def test_every_transition_of_cia_402(monkeypatch):
    seen = seen_by(monkeypatch, Drive402)
    for words in TO_402.values():
        lost(master_at(words), (VOLTAGE_OFF, RESET))
    for words in ((SHUTDOWN, VOLTAGE_OFF, SHUTDOWN, STOP),
                  (SHUTDOWN, ENABLE, ENABLE, SWITCH_ON, SHUTDOWN),
                  (SHUTDOWN, SWITCH_ON, VOLTAGE_OFF, SHUTDOWN, SWITCH_ON, STOP),
                  (*TO_402['OPERATION_ENABLED'], SHUTDOWN),
                  (*TO_402['OPERATION_ENABLED'], VOLTAGE_OFF),
                  (*TO_402['QUICK_STOP'], VOLTAGE_OFF), (*TO_402['QUICK_STOP'], *[STOP] * 30)):
        master_at(words)
    for words in TO_402.values():
        master_at(words).device.end_operation(is_lost=False)
    stays = master_at(TO_402['OPERATION_ENABLED'])
    stays.download(0x605A, 0, 6)
    for word in (STOP, *[STOP] * 30, ENABLE):
        stays.cycle(word)
    for command in ({'is_enabled': False}, {'quick_stop': True}):
        other = master_at((*TO_402['OPERATION_ENABLED'], ENABLE))
        other.rig.simulation.command('ram', **command)
        other.rig.simulation.step()
        other.device.take_sample(other.rig.sample, 0)
    for words in ((SHUTDOWN, SHUTDOWN), (*TO_402['SWITCHED_ON'], SWITCH_ON),
                  TO_402['OPERATION_ENABLED']):
        stopped = master_at(words[:-1])
        stopped.rig.simulation.emergency_stop()
        stopped.cycle(words[-1])
    fresh, = devices_of(isa_ros.load('rig_linear').configuration)
    fresh.end_operation(is_lost=True)
    assert seen == rows(cia402_states)


def test_every_transition_of_cia_408(monkeypatch):
    seen = seen_by(monkeypatch, Drive408)
    for words in TO_408.values():
        lost(master_at(words, 'cia408', 9), (words[-1] & DISABLED if words else INIT, R))
    master_at((*TO_408['ACTIVE'], HOLD, DISABLED, INIT), 'cia408', 9)
    lost(master_at(TO_408['ACTIVE'], 'cia408', 9), (HOLD, HOLD | R))
    lost(master_at(TO_408['ACTIVE'], 'cia408', 9), (DISABLED, INIT, R))
    lost(master_at(TO_408['ACTIVE'], 'cia408', 9), (DISABLED, DISABLED | R))
    master_at(TO_408['ACTIVE'], 'cia408', 9).device.end_operation(is_lost=False)
    for words in (TO_408['HOLD'], TO_408['ACTIVE']):
        master = master_at((*words, words[-1]), 'cia408', 9)
        master.rig.simulation.command('ram', is_enabled=False)
        master.rig.simulation.step()
        master.device.take_sample(master.rig.sample, 0)
    tripped = master_at(TO_408['ACTIVE'], 'cia408', 9)
    lost(tripped)
    tripped.rig.simulation.tune('supply', {'pressure_mpa': 1.0})
    for _ in range(60):
        tripped.cycle(HOLD)
    assert seen == rows(cia408_states)


@pytest.mark.parametrize('states', [cia402_states, cia408_states])
def test_no_row_of_a_table_is_there_twice(states):
    assert len(rows(states)) == len(states.TRANSITIONS)
