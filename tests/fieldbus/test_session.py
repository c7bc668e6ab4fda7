"""Sessions whose commands come from a bus: what is refused, and the bag of a run on toys."""

import hashlib
import math
from pathlib import Path
import struct

from isa_ros.bag.reader import Bag
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.errors import ConfigError
from isa_ros.fieldbus.device.devices import devices_of
from isa_ros.fieldbus.request import BusRequest, ETHERCAT, REAL_TIME
from isa_ros.fieldbus.session import BusRun, prepare_bus
from isa_ros.replay.replay import recorded_events, recorded_inputs, replay
from isa_ros.run.coordinator import Interrupted
from isa_ros.run.options import Request
from isa_ros.run.session import prepare
from isa_ros.run.without_ros import run_without_ros
import pytest
from tests.fieldbus.toy_line import ENABLE, SILENCE, ToyLine, toys_of

MASTER = [(0, 0), (0, 0), (6, 0), *[(ENABLE, 100 * k) for k in range(30)]]


def prepared(tmp_path: Path, cycles=(), config='rig_linear', pace='frame', **request) -> BusRun:
    """Return a session on toys with a master that sends ``cycles``."""
    lines: list[str] = []
    return prepare_bus(
        BusRequest(
            run=Request(config=find(config, CONFIG), out=tmp_path / 'bag', **request),
            bus=ETHERCAT, arguments={'interface': 'toy'}, pace=pace, watchdog_ms=5.0),
        toys_of, lambda devices, step_ns: ToyLine(devices, cycles), lines.append)


def bytes_of(tmp_path: Path, cycles) -> str:
    """Return the sha256 of the bag of a run with these cycles."""
    run = prepared(tmp_path, cycles, duration_s=0.02)
    run_without_ros(run.session, None, lambda: False)
    (file,) = (tmp_path / 'bag').glob('*.mcap')
    return hashlib.sha256(file.read_bytes()).hexdigest()


def test_a_master_that_stalls_gives_the_same_bytes(tmp_path: Path,
                                                   monkeypatch: pytest.MonkeyPatch):
    """Cycles before the first control word, and silence between cycles, leave no trace."""
    monkeypatch.setattr('isa_ros.fieldbus.source.SLICE_S', 1e-3)
    stalled = [(0, 0), SILENCE, (0, 0), (0, 0)]
    for cycle in MASTER[2:]:
        stalled += [SILENCE] * 7 + [cycle]
    free = bytes_of(tmp_path / 'free', MASTER)
    assert bytes_of(tmp_path / 'stalled', stalled) == free
    assert bytes_of(tmp_path / 'other', [*MASTER[:9], (6, 0), *MASTER[9:]]) != free


def test_a_bag_of_a_bus_is_replayed_without_a_master(tmp_path: Path):
    """The setpoints it has sent are applied setpoints, after that of t = 0."""
    bytes_of(tmp_path, MASTER)
    bag = Bag(tmp_path / 'bag')
    report = replay(bag)
    assert report.is_equal and report.is_whole and report.report.ticks == 21
    applied = [m for m in bag.messages() if m.topic.endswith('/applied_setpoint')]
    assert len(applied) == 1 + 20


def test_a_bag_of_a_bus_with_a_warm_tank_is_replayed_in_memory(tmp_path: Path):
    """The tank's temperature reaches the actuators of a bus, and their heat the tank."""
    run = prepared(tmp_path, MASTER, config='warm_stand', duration_s=0.02)
    run_without_ros(run.session, None, lambda: False)
    bag = Bag(tmp_path / 'bag')
    report = replay(bag)
    assert report.is_equal and report.is_whole and report.report.ticks == 21
    assert '/station/tank_oil_temperature' in bag.types


def test_what_the_watchdog_does_is_replayed_too(tmp_path: Path):
    """In real time, after a control word and silence: an event at its tick."""
    run = prepared(tmp_path, [(ENABLE, 0)], pace=REAL_TIME, duration_s=0.05)
    run_without_ros(run.session, None, lambda: False)
    bag = Bag(tmp_path / 'bag')
    ((tick, texts),) = recorded_events(bag).items()
    assert texts == ['bus: no process data for 5 ms'] and tick >= 5
    assert replay(bag).is_equal
    assert str(run.summary).startswith('50 ticks in real time: lateness p50 ')


def test_actuators_wait_for_their_master(tmp_path: Path):
    run = prepared(tmp_path).session.run
    assert [actuator.auto_enable for actuator in run.actuators] == [False]


def test_a_line_that_cannot_be_opened_leaves_no_bag(tmp_path: Path):
    def refuse(devices, step_ns):
        raise ConfigError('--interface ecs: no such interface')
    run = prepare_bus(
        BusRequest(run=Request(config=find('rig_linear', CONFIG), out=tmp_path / 'bag'),
                   bus=ETHERCAT, arguments={'interface': 'ecs'}), toys_of, refuse, print)
    with pytest.raises(ConfigError, match='--interface ecs: no such interface'):
        run_without_ros(run.session, None, lambda: False)
    assert not (tmp_path / 'bag').exists()


def test_a_link_is_refused(tmp_path: Path):
    with pytest.raises(ConfigError, match=(
            'link of .*: must be none under isa bus, whose bus is the link')):
        prepared(tmp_path, changes=(
            'link.kind=ethercat', 'link.cycle_ms=1.0', 'link.delay_cycles=1'))


def test_tracks_are_refused(tmp_path: Path):
    with pytest.raises(ConfigError, match=(
            'scenario .*: tracks of .*: not used under isa bus, whose master commands')):
        prepared(tmp_path, config='leg', scenario=find('drop', SCENARIOS))


def broken(tmp_path: Path, fault: str) -> Path:
    """Return a scenario with a fault of the connection of the ram from 5 to 9 ms."""
    path = tmp_path / 'broken.yaml'
    path.write_text('name: broken\nduration_s: 0.02\nfaults:\n'
                    f'- {{t_s: 0.005, bus: ram, set: {{{fault}: 1}}, until_s: 0.009}}\n')
    return path


def test_a_broken_connection_is_an_event_that_is_replayed(tmp_path: Path):
    run = prepared(tmp_path, MASTER, scenario=broken(tmp_path, 'pulled'))
    run_without_ros(run.session, None, lambda: False)
    bag = Bag(tmp_path / 'bag')
    assert recorded_events(bag) == {
        5: ['bus: ram pulled begins'], 9: ['bus: ram pulled ends']}
    assert replay(bag).is_equal


def test_a_fault_that_a_bus_does_not_have_is_refused(tmp_path: Path):
    with pytest.raises(ConfigError, match=(
            'scenario broken: fault bus_off of bus: ram is not one of isa bus ethercat, which has '
            'pulled, powerless')):
        prepared(tmp_path, scenario=broken(tmp_path, 'bus_off'))


def test_without_a_bus_a_broken_connection_is_refused(tmp_path: Path):
    with pytest.raises(ConfigError, match='broken: a fault of bus: ram is used under isa bus'):
        prepare(Request(config=find('rig_linear', CONFIG), out=tmp_path / 'bag',
                        scenario=broken(tmp_path, 'pulled')))


def test_real_time_has_no_factor(tmp_path: Path):
    with pytest.raises(ConfigError, match=(
            '--real-time-factor 0.5 is not used with --pace real_time')):
        prepared(tmp_path, pace=REAL_TIME, real_time_factor=0.5)


def test_a_line_is_closed_however_a_run_ends(tmp_path: Path):
    lines: list[ToyLine] = []

    def opened(devices, step_ns):
        lines.append(ToyLine(devices, MASTER))
        return lines[-1]
    run = prepare_bus(
        BusRequest(run=Request(config=find('rig_linear', CONFIG), out=tmp_path / 'bag'),
                   bus=ETHERCAT, arguments={'interface': 'toy'}),
        toys_of, opened, lambda line: None)
    with pytest.raises(Interrupted, match='stopped at t = 0.000000 s'):
        run_without_ros(run.session, None, lambda: True)
    assert [line.log[-1:] for line in lines] == [['close']]


class GainLine(ToyLine):
    """Writes the gain of the force loop over SDO in its tenth cycle."""

    WRITTEN = 3e-5

    def serve(self, timeout: float) -> bool:
        device = self.devices[0]
        cycle = self.log.count('cycle')
        control = (0x06, 0x07, 0x0F)[min(cycle, 2)]
        device.receive(0x1610, struct.pack(
            '<Hbxiiihhff', control, 8, 50_000, 0, 0, 0, 0, math.nan, math.nan))
        if cycle == 10:
            (key,) = [(entry.index, entry.subindex) for entry in device.table.entries
                      if entry.name == 'force.kp']
            device.write(*key, struct.pack('<f', self.WRITTEN), is_preoperational=False)
        self.log.append('cycle')
        return True


def test_a_gain_written_over_sdo_is_recorded_and_replayed(tmp_path: Path):
    """As one set by a ROS parameter: with the tick at which it took effect."""
    run = prepare_bus(
        BusRequest(run=Request(config=find('rig_linear', CONFIG), out=tmp_path / 'bag',
                               duration_s=0.03), bus=ETHERCAT, arguments={'interface': 'toy'}),
        devices_of, lambda devices, step_ns: GainLine(devices, ()), lambda line: None)
    run_without_ros(run.session, None, lambda: False)
    bag = Bag(tmp_path / 'bag')
    ((_, values),) = recorded_inputs(bag, run.session.run).tuned['ram'].items()
    assert values == {'force.kp': struct.unpack('<f', struct.pack('<f', GainLine.WRITTEN))[0]}
    assert replay(bag).is_equal
