"""The barrier and the run, with fakes for actuators, load and recorder."""

from collections.abc import Sequence

from isa_ros.coordinator import Coordinator, Interrupted, Messages, Order, Plan, Records
from isa_ros.errors import RunError, SimulationDiverged
from isa_ros.pacing import Pace, ProgressMeter
from isa_ros.signals import LOAD_PORT
import numpy as np
import pytest

STEP_NS = 1_000_000
TOPICS = [['/b/state', '/b/applied'], ['/a/state'], ['/clock'], ['/supply']]


class FakeTransport:
    """Two participants that answer with the tick; the first applies something at tick 1."""

    def __init__(self, log: list[str]) -> None:
        self.log = log
        self.failure: Exception | None = None
        self.fails_at = -1
        self.tick = 0

    def join(self) -> Sequence[Messages]:
        return self._answers(0)

    def publish_clock(self, clock: bytes) -> None:
        self.log.append(f'clock {clock.decode()}')

    def send(self, tick: int, ports: Records, commands: Records) -> None:
        self.tick = tick
        self.log.append(f'send {tick} x0={ports["x0"][0]:g} kinds={commands["kinds"].tolist()}')

    def receive(self, replies: Records) -> Sequence[Messages]:
        if self.tick == self.fails_at and self.failure is not None:
            raise self.failure
        self.log.append(f'receive {self.tick}')
        replies['force'] = self.tick
        return self._answers(self.tick + 1)

    def publish(self, messages: Messages) -> None:
        self.log.append('publish')

    def _answers(self, sequence: int) -> Sequence[Messages]:
        applied = b'applied' if sequence in (0, 2) else None
        return [[b'b%d' % sequence, applied], [b'a%d' % sequence]]


class FakeLoad:
    """A load whose position counts the ticks."""

    def __init__(self, log: list[str]) -> None:
        self.log = log
        self._ports = np.zeros(2, LOAD_PORT)

    def ports(self) -> Records:
        return self._ports

    def advance(self, replies: Records) -> None:
        self.log.append(f'advance {replies["force"][0]:g}')
        self._ports['x0'] += 1.0

    def messages(self, t_ns: int) -> Messages:
        return (b'supply%d' % t_ns,)

    def clock(self, t_ns: int) -> bytes:
        return b'%d' % t_ns


class FakeRecorder:
    """Keeps what it is given."""

    def __init__(self, log: list[str]) -> None:
        self.log = log
        self.samples: list[tuple[int, int, list[tuple[int, bytes]]]] = []

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        self.log.append(f'record {sequence}')
        self.samples.append((t_ns, sequence, list(messages)))


class Rig:
    """One coordinator with its fakes."""

    def __init__(self, n_ticks: int | None = 3) -> None:
        self.log: list[str] = []
        self.transport = FakeTransport(self.log)
        self.recorder = FakeRecorder(self.log)
        self.stops_at: int | None = None
        plan = Plan(step_ns=STEP_NS, n_actuators=2, n_ticks=n_ticks, commands=self.command)
        self.order = Order(TOPICS)
        self.coordinator = Coordinator(
            plan, self.order, self.transport, FakeLoad(self.log), self.recorder,
            pace=Pace(), progress=ProgressMeter(None, None), should_stop=self.should_stop)

    def command(self, tick: int, rows: Records) -> None:
        assert not rows['kinds'].any()
        rows['kinds'][1] = tick

    def should_stop(self) -> bool:
        return self.coordinator.ticks == self.stops_at

    def run(self) -> None:
        self.coordinator.run(self.transport.join())

    @property
    def sequences(self) -> list[int]:
        return [sequence for _, sequence, _ in self.recorder.samples]


def test_n_ticks_give_n_plus_1_samples():
    rig = Rig(3)
    rig.run()
    assert rig.sequences == [0, 1, 2, 3]
    assert [t_ns for t_ns, _, _ in rig.recorder.samples] == [0, 1_000_000, 2_000_000, 3_000_000]


def test_order_of_a_tick():
    """Clock of the tick's end first; the last sample is recorded while actuators work."""
    rig = Rig(2)
    rig.run()
    assert rig.log == [
        'clock 0', 'publish',
        'clock 1000000', 'send 0 x0=0 kinds=[0, 0]', 'record 0',
        'receive 0', 'advance 0', 'publish',
        'clock 2000000', 'send 1 x0=1 kinds=[0, 1]', 'record 1',
        'receive 1', 'advance 1', 'publish',
        'record 2']


def test_sample_is_in_canonical_order():
    """Topics sorted by name, whatever the order of the participants; absent ones left out."""
    rig = Rig(2)
    rig.run()
    assert rig.order.topics == ('/a/state', '/b/applied', '/b/state', '/clock', '/supply')
    assert rig.recorder.samples[1][2] == [
        (0, b'a1'), (2, b'b1'), (3, b'1000000'), (4, b'supply1000000')]
    assert rig.recorder.samples[2][2][1] == (1, b'applied')


def test_a_topic_has_one_source():
    with pytest.raises(ValueError, match='two sources'):
        Order([['/clock'], ['/clock']])


def test_stop_finishes_the_tick_and_records_it():
    rig = Rig(None)
    rig.stops_at = 2
    with pytest.raises(Interrupted, match=r't = 0\.002000 s after 2 ticks') as raised:
        rig.run()
    assert raised.value.exit_code == 130
    assert rig.sequences == [0, 1, 2]
    assert rig.log[-2:] == ['publish', 'record 2']


@pytest.mark.parametrize('failure', [
    RunError('kfe: no answer to tick 2'), SimulationDiverged(3_000_000, 'kfe: spool', np.nan)])
def test_finished_ticks_are_recorded_when_an_actuator_fails(failure):
    rig = Rig(9)
    rig.transport.failure, rig.transport.fails_at = failure, 2
    with pytest.raises(type(failure)) as raised:
        rig.run()
    assert raised.value is failure
    assert rig.sequences == [0, 1, 2]


def test_lost_recorder_ends_the_run():
    rig = Rig(9)

    def write_tick(t_ns, sequence, messages):
        if sequence == 2:
            raise RunError('drop_0.mcap: cannot record, No space left on device')
        rig.recorder.samples.append((t_ns, sequence, list(messages)))
    rig.recorder.write_tick = write_tick
    with pytest.raises(RunError, match='No space left'):
        rig.run()
    assert rig.sequences == [0, 1]
    assert rig.coordinator.ticks == 2
