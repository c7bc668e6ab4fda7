"""The master as a source of commands, in frame pace."""

from isa_ros.core.signals import COMMAND, SAMPLE
from isa_ros.fieldbus.source import FrameSource
from isa_ros.run import pacing
from isa_ros.scenario.faults import ParameterChanges
import numpy as np
import pytest
from tests.fieldbus.toy_line import ENABLE, SILENCE, ToyDevice, ToyLine


class Bus:
    """Two toys on a line, and the rows of their run."""

    def __init__(self, *cycles, faults=lambda tick: None) -> None:
        self.devices = [ToyDevice('hip'), ToyDevice('knee')]
        self.line = ToyLine(self.devices, cycles)
        self.source = FrameSource(self.line, self.devices, faults)
        self.samples = np.zeros(2, SAMPLE)
        self.rows = np.zeros(2, COMMAND)

    def is_due(self, tick: int) -> bool:
        self.samples['position'] = tick
        return self.source.is_due(tick, self.samples)


@pytest.fixture(autouse=True)
def short_slice(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wait for 1 ms only where the master is silent."""
    monkeypatch.setattr('isa_ros.fieldbus.source.SLICE_S', 1e-3)
    assert pacing.SLICE_S > 1e-3


def test_time_begins_with_the_first_control_word():
    """Cycles before it are answered without a tick: with the sample of t = 0."""
    bus = Bus((0, 0), (0, 0), (6, 0), (0, 0))
    assert bus.is_due(0)
    assert bus.line.log == ['update', 'cycle 0', 'update', 'cycle 0', 'update', 'cycle 6']
    assert bus.devices[0].samples == [(0, 0.0)]
    assert bus.is_due(1)
    assert bus.line.log[6:] == ['update', 'cycle 0']


def test_a_silent_master_makes_no_tick():
    bus = Bus((6, 0), SILENCE)
    assert bus.is_due(0)
    assert not bus.is_due(1)
    assert not bus.is_due(1)


def test_devices_have_the_sample_of_a_tick_once_before_its_cycle():
    """Also when the run asks for the tick again and again."""
    bus = Bus((6, 0))
    bus.is_due(0)
    for _ in range(3):
        bus.is_due(1)
    assert bus.devices[1].samples == [(0, 0.0), (1, 1.0)]
    assert bus.line.log.count('update') == 2


def test_a_run_that_is_reset_gives_the_sample_at_0_again():
    bus = Bus((6, 0), (6, 0), (6, 0))
    assert [bus.is_due(0), bus.is_due(1), bus.is_due(0)] == [True] * 3
    assert [tick for tick, _ in bus.devices[0].samples] == [0, 1, 0]


def test_the_last_samples_are_sent_too():
    """On CANopen and the serial line a cycle is answered with the state after it."""
    bus = Bus((6, 0))
    bus.is_due(0)
    bus.samples['position'] = 7.0
    bus.source.end(1, bus.samples)
    assert bus.devices[0].samples[-1] == (1, 7.0)
    assert bus.line.log[-1] == 'update'


def test_what_the_master_sent_is_the_command_of_the_tick():
    bus = Bus((ENABLE, 2500))
    bus.is_due(0)
    bus.source.commands(0, bus.rows)
    assert bus.rows['is_enabled'].tolist() == [1, 1]
    assert bus.rows['position'].tolist() == [2500e-6, 2500e-6]


def test_what_is_written_over_sdo_changes_parameters_beside_the_faults():
    """Of the same parameter the master's value is the last."""
    bus = Bus(faults={3: ParameterChanges(
        {0: {'plant.spool.stuck': 1.0}, 1: {'force.kp': 1.0}}, {'supply.pressure_mpa': 14.0})}.get)
    assert bus.source.changes(2) is None
    bus.devices[1].written = {'force.kp': 2.0}
    assert bus.source.changes(2) == ParameterChanges({1: {'force.kp': 2.0}}, {})
    bus.devices[1].written = {'force.kp': 3.0}
    assert bus.source.changes(3) == ParameterChanges(
        {0: {'plant.spool.stuck': 1.0}, 1: {'force.kp': 3.0}}, {'supply.pressure_mpa': 14.0})


def test_what_is_tuned_elsewhere_reaches_its_device():
    bus = Bus((6, 0))
    bus.source.take_tuned({1: {'force.kp': 2e-7}})
    assert [device.shown for device in bus.devices] == [{}, {'force.kp': 2e-7}]


PULL, UNPLUG = {'hip': {'pulled': 1.0}}, {'hip': {'pulled': 0.0}, 'knee': {'powerless': 1.0}}


def cut(faults=((1, PULL), (3, UNPLUG))) -> Bus:
    """Return a bus with faults of its connections by tick."""
    by_tick = {tick: ParameterChanges({}, {}, ports) for tick, ports in faults}
    return Bus(*[(6, 0)] * 9, faults=by_tick.get)


def test_a_connection_fails_before_the_cycle_of_its_tick():
    bus = cut()
    found = []
    for tick in range(5):
        bus.is_due(tick)
        bus.source.commands(tick, bus.rows)
        found.append(bus.source.events(tick))
    assert found == [
        [], ['bus: hip pulled begins'], [], ['bus: hip pulled ends', 'bus: knee powerless begins'],
        []]
    assert bus.line.log[:5] == ['update', 'cycle 6', 'hip pulled True', 'update', 'cycle 6']
    assert bus.line.ports == [
        ('hip', 'pulled', True), ('hip', 'pulled', False), ('knee', 'powerless', True)]


def test_what_is_missing_at_the_start_is_missing_before_the_first_frame():
    bus = cut(faults=((0, PULL),))
    bus.is_due(0)
    assert bus.line.log[:2] == ['hip pulled True', 'update']
    assert bus.source.events(0) == ['bus: hip pulled begins']


def test_a_run_that_continues_has_the_faults_that_last():
    bus = cut()
    bus.is_due(2)
    assert bus.line.ports == [('hip', 'pulled', True)]


def test_a_run_that_is_reset_is_connected_again():
    bus = cut()
    for tick in (0, 1, 2, 3, 0, 1):
        bus.is_due(tick)
    assert bus.line.ports[3:] == [('knee', 'powerless', False), ('hip', 'pulled', True)]
