"""The barrier and the run, with fakes for actuators, surroundings and recorder."""

from collections.abc import Callable, Mapping, Sequence
import itertools
from typing import Any

from isa_ros.core.saved_state import RunState
from isa_ros.core.signals import HAS_SETPOINT, Records
from isa_ros.errors import ConfigError, RunError, SimulationDiverged
from isa_ros.run.coordinator import Coordinator, Interrupted
from isa_ros.run.output import Outlets, packer_of, RunOutput
from isa_ros.run.pacing import Pace, ProgressMeter
from isa_ros.run.packing import Messages
from isa_ros.scenario.faults import ParameterChanges
from isa_ros.surroundings.body import Body
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE
from isa_ros.tick.exchange import IDLE_S, Rows
from isa_ros.tick.tick_loop import TickLoop
from msg_adapters import event
from msg_adapters.cdr_reader import decode
import numpy as np
import pytest
from rosgraph_msgs.msg import Clock
from tests.run.recorder import FakeRecorder
from tests.runs import hip_and_knee
from tests.sheets import setpoint

STEP_NS = 1_000_000
RUN = hip_and_knee()


class FakeTransport:
    """Two participants whose position is the tick; the first applies something at tick 1."""

    group = None
    is_quiet = False
    ends = None

    def __init__(self, log: list[str]) -> None:
        self.log = log
        self.failure: Exception | None = None
        self.fails_at = -1
        self.asks_at = -1
        self.tick = 0

    def join(self, rows: Rows) -> None:
        self._answer(0, rows)

    def restore(self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> None:
        self.log.append(f'restore {tick} {snapshots}')
        self._answer(tick, rows)

    def begin(self) -> None:
        self.log.append('begin')

    def send(self, tick: int, rows: Rows) -> None:
        self.tick = tick
        self.log.append(
            f'send {tick} x0={rows.ports["x0"][0]:g} kinds={rows.commands["kinds"].tolist()}')

    def receive(self, rows: Rows) -> None:
        if self.tick == self.fails_at and self.failure is not None:
            raise self.failure
        self.log.append(f'receive {self.tick}')
        rows.replies['force'] = self.tick
        if self.tick == self.asks_at:
            rows.requests[0] = setpoint(position=0.5)
        self._answer(self.tick + 1, rows)

    def idle(self, seconds: float = IDLE_S) -> None:
        self.log.append('idle' if seconds else 'inputs')

    def snapshots(self) -> list[bytes]:
        return [b'b', b'a']

    def _answer(self, sequence: int, rows: Rows) -> None:
        rows.samples['position'] = sequence
        rows.applied['kinds'][0] = HAS_SETPOINT if sequence in (0, 2) else 0
        rows.tuned = {1: {'force.kp': 1e-7}} if sequence == 2 else {}


class FakeSurroundings:
    """Surroundings whose position and pressure count the ticks."""

    bodies: dict[str, Body] = {}

    def __init__(self, log: list[str]) -> None:
        self.log = log
        self.supplies = np.zeros(1, SUPPLY_SAMPLE)
        self.has_supply_ports = False
        self.tuned: dict[str, float] = {}

    def tune(self, values: Mapping[str, float]) -> None:
        self.log.append(f'tune {dict(values)}')
        self.tuned = dict(values)

    def ports(self, ports: Records) -> None:
        ports['x0'] = self.supplies['pressure']

    def advance(self, replies: Records, fed: Records | None = None) -> None:
        self.log.append(f'advance {replies["force"][0]:g}')
        self.supplies['pressure'] += 1.0

    def snapshot(self) -> bytes:
        return self.supplies.tobytes()

    def restart(self, beginning: bytes) -> None:
        self.restore(beginning)

    def restore(self, snapshot: bytes) -> None:
        self.supplies[:] = np.frombuffer(snapshot, SUPPLY_SAMPLE)


class FakeSource:
    """Commands the second actuator by the tick; a test gives waits, events and changes."""

    def __init__(
            self, log: list[str], changes: Callable[[int], ParameterChanges | None]) -> None:
        self.log, self.changes = log, changes
        self.waits: dict[int, int] = {}
        self.happened: dict[int, str] = {}
        self.told: dict[int, Mapping[int, Mapping[str, float]]] = {}

    def is_due(self, tick: int, samples: Records) -> bool:
        if self.waits.get(tick, 0):
            self.waits[tick] -= 1
            self.log.append(f'no command {tick} position={samples["position"][0]:g}')
            return False
        return True

    def quiet_until(self, tick: int) -> float:
        return tick

    def commands(self, tick: int, out: Records) -> None:
        out['kinds'][1] = tick

    def events(self, tick: int) -> list[str]:
        return [self.happened[tick]] if tick in self.happened else []

    def take_tuned(self, tuned: Mapping[int, Mapping[str, float]]) -> None:
        self.told[len(self.log)] = tuned

    def end(self, tick: int, samples: Records) -> list[str]:
        self.ended = tick, float(samples['position'][0])
        return self.events(tick)


class FakeOutlet:
    """Writes down what is published."""

    wanted = None

    def __init__(self, log: list[str], line: Callable[[bytes], str]) -> None:
        self.log, self.line = log, line

    def has_subscribers(self) -> bool:
        return True

    def publish(self, messages: Messages) -> None:
        # Of the surroundings the pressure of the supply; before it what was tuned.
        data = messages[min(1, len(messages) - 1)]
        if data is not None:    # None: the diagnostics of the end
            self.log.append(self.line(data))


def clock_line(data: bytes) -> str:
    time = decode(data, Clock).clock
    return f'clock {time.sec * 10**9 + time.nanosec}'


class Rig:
    """One coordinator with its fakes, and the output of a run."""

    def __init__(
            self, n_ticks: int | None = 3, pace: Pace | None = None,
            changes: Callable[[int], ParameterChanges | None] = lambda tick: None,
            **plan: Any) -> None:
        self.asked: dict[int, Callable[[Coordinator], object]] = {}
        self.log: list[str] = []
        self.transport = FakeTransport(self.log)
        self.source = FakeSource(self.log, changes)
        self.recorder = FakeRecorder(self.log)
        self.stops_at: int | None = None
        self.looks = 0
        surroundings = FakeSurroundings(self.log)
        self.rows = Rows(2, surroundings)
        packer = packer_of(RUN, self.rows.published)
        self.topics = [topic.name for topic in packer.topics]
        output = RunOutput(packer, RUN.step_ns, self.recorder, Outlets(
            clock=FakeOutlet(self.log, clock_line),
            events=FakeOutlet(self.log, lambda data: f'event {event.text(data)}'),
            surroundings=FakeOutlet(self.log, lambda data: 'publish')))
        self.loop = TickLoop(STEP_NS, self.transport, surroundings, self.rows, self.source)
        self.loop.sinks = (output,)
        self.coordinator = Coordinator(
            self.loop, n_ticks, **plan, pace=pace or Pace(),
            progress=ProgressMeter(None, None), should_stop=self.should_stop, requests=self.ask)

    def ask(self, coordinator: Coordinator) -> None:
        """Ask for what a test wants at this look, counted from 0."""
        self.looks += 1
        self.asked.get(self.looks - 1, lambda run: None)(coordinator)

    def should_stop(self) -> bool:
        return self.coordinator.ticks == self.stops_at

    def run(self, state: RunState | None = None) -> None:
        self.loop.join()
        self.coordinator.run(state)

    @property
    def events(self) -> dict[int, list[str]]:
        """Return the recorded events by sequence, each stamped with its instant."""
        place, said = self.topics.index('/coordinator/events'), {}
        for t_ns, sequence, messages in self.recorder.samples:
            own = [data for topic, data in messages if topic == place]
            texts = [event.text(data) for data in own]
            assert own == [event.pack(t_ns, text) for text in texts]
            if texts:
                said[sequence] = texts
        return said

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
        'clock 0', 'begin', 'publish',
        'clock 1000000', 'send 0 x0=0 kinds=[0, 0]', 'record 0',
        'receive 0', 'advance 0', 'publish',
        'clock 2000000', 'send 1 x0=1 kinds=[0, 1]', 'record 1',
        'receive 1', 'advance 1', 'publish',
        'record 2']


def test_every_sample_is_of_its_own_instant():
    """The clock in it, what was applied at its tick's start, and what was tuned then."""
    rig = Rig(2)
    rig.run()
    said = [{rig.topics[k]: data for k, data in messages}
            for _, _, messages in rig.recorder.samples]
    assert [clock_line(own['/clock']) for own in said] == ['clock 0', 'clock 1000000',
                                                           'clock 2000000']
    assert ['/hip/applied_setpoint' in own for own in said] == [True, False, True]
    assert ['/knee/applied_parameters' in own for own in said] == [False, False, True]
    assert [sorted(own) == list(own) for own in said] == [True] * 3


def test_stop_finishes_the_tick_and_records_it():
    rig = Rig(None)
    rig.stops_at = 2
    with pytest.raises(Interrupted, match=r't = 0\.002000 s after 2 ticks') as raised:
        rig.run()
    assert raised.value.exit_code == 130
    assert rig.sequences == [0, 1, 2] and not rig.events
    assert rig.log[-2:] == ['publish', 'record 2']


@pytest.mark.parametrize('failure', [
    RunError('kfe: no answer to tick 2'), SimulationDiverged(3_000_000, 'kfe: spool', np.nan)])
def test_finished_ticks_are_recorded_when_an_actuator_fails(failure):
    rig = Rig(9)
    rig.transport.failure, rig.transport.fails_at = failure, 2
    with pytest.raises(type(failure)) as raised:
        rig.run()
    assert raised.value is failure
    assert rig.sequences == [0, 1, 2, 2]    # its samples, which are recorded already; the event
    assert rig.events == {2: [f'ended by an error: {failure}']}


def test_an_error_between_two_ticks_is_recorded_with_the_last_one():
    """One of the body: what it gives is not sent."""
    rig = Rig(9)

    def ports(ports):
        if rig.loop.ticks == 2:
            raise SimulationDiverged(2_000_000, 'body.port_x0[0] (hip)', np.nan)
        ports['x0'] = 0.0
    rig.loop._surroundings.ports = ports
    with pytest.raises(SimulationDiverged):
        rig.run()
    assert rig.sequences == [0, 1, 2]
    assert rig.events[2][0].startswith('ended by an error: body.port_x0[0] (hip) = nan at t = 0.0')
    assert rig.log[-2].startswith('event ended by an error') and rig.log[-1] == 'record 2'


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


def test_what_a_controller_asks_for_takes_effect_once_at_the_next_tick():
    """Asked in tick 0, in force from tick 1; the scenario writes over it."""
    rig = Rig(3)
    rig.transport.asks_at = 0
    rig.run()
    assert [line for line in rig.log if line.startswith('send')] == [
        'send 0 x0=0 kinds=[0, 0]', 'send 1 x0=1 kinds=[1, 1]', 'send 2 x0=2 kinds=[0, 2]']


def test_a_paused_run_ticks_only_when_stepped():
    """Paused after a tick, two steps, then on to the end; each recorded where it was done."""
    rig = Rig(5)
    rig.asked = {1: lambda run: run.pause(True), 3: lambda run: run.step(2),
                 5: lambda run: run.pause(False)}
    rig.run()
    assert rig.sequences == [0, 1, 2, 3, 4, 5]
    idles = [k for k, line in enumerate(rig.log) if line == 'idle']
    sends = [k for k, line in enumerate(rig.log) if line.startswith('send')]
    assert [sum(idle < send for idle in idles) for send in sends] == [0, 2, 2, 4, 4]
    assert rig.events == {1: ['pause', 'step 2'], 3: ['resume']}
    assert [line for line in rig.log if line.startswith('event')] == [
        'event pause', 'event step 2', 'event resume']


def test_a_step_is_refused_unless_paused():
    rig = Rig(3)
    rig.asked = {1: lambda run: run.step(1)}
    with pytest.raises(ConfigError, match='step: the run is not paused'):
        rig.run()


def test_a_step_does_not_go_beyond_the_end():
    rig = Rig(3, is_paused=True)
    rig.asked = {0: lambda run: run.step(100)}
    rig.run()
    assert rig.sequences == [0, 1, 2, 3]


def test_a_run_may_begin_paused():
    rig = Rig(2, is_paused=True)
    rig.asked = {3: lambda run: run.pause(False)}
    rig.run()
    assert rig.log.index('send 0 x0=0 kinds=[0, 0]') > rig.log.index('idle')
    assert rig.sequences == [0, 1, 2]


def test_a_stop_ends_a_pause():
    rig = Rig(3, is_paused=True)
    rig.stops_at = 0
    with pytest.raises(Interrupted, match='after 0 ticks'):
        rig.run()
    assert rig.sequences == [0]


def test_a_reset_ends_the_run_where_it_is():
    rig = Rig(9)
    rig.asked = {2: lambda run: run.reset()}
    rig.run()
    assert rig.coordinator.is_reset
    assert rig.sequences == [0, 1, 2]
    assert rig.events == {2: ['reset']}


def test_a_saved_run_goes_on_where_it_was():
    """Tick, load, participants and what controllers asked for; the sample there comes first."""
    first, states = Rig(4), []
    first.transport.asks_at = 1
    first.asked = {2: lambda run: states.append(run.save())}
    first.run()
    again = Rig(4)
    again.run(states[0])
    assert f'restore 2 {[b"b", b"a"]}' in again.log
    assert again.recorder.samples == first.recorder.samples[2:]
    sent = [line for line in first.log if line.startswith('send')][2:]
    assert [line for line in again.log if line.startswith('send')] == sent
    assert sent[0] == 'send 2 x0=2 kinds=[1, 2]'


def test_a_run_that_ends_paused_was_not_behind():
    """However long it was paused: a minute at each look."""
    clock = itertools.count(step=60)
    pace = Pace(1.0, now=lambda: float(next(clock)), sleep=lambda seconds: None)
    rig = Rig(None, pace)
    rig.asked = {2: lambda run: run.pause(True), 5: lambda run: setattr(rig, 'stops_at', 2)}
    with pytest.raises(Interrupted, match='after 2 ticks'):
        rig.run()
    assert rig.log[-2:] == ['idle', 'record 2'] and pace.shortfall is None


def test_another_pace_counts_from_now():
    rig = Rig(2)
    rig.asked = {1: lambda run: run.set_real_time_factor(1e6)}
    rig.run()
    assert rig.sequences == [0, 1, 2]
    with pytest.raises(ConfigError, match='real_time_factor = -1'):
        rig.coordinator.set_real_time_factor(-1.0)


def test_faults_change_supplies_and_actuators_before_the_tick_of_their_time():
    """And only there: the transport finds them in its rows when it starts that tick."""
    at_1 = ParameterChanges({1: {'plant.spool.stuck': 1.0}}, {'supply.pressure_mpa': 10.0})
    seen = []
    rig = Rig(3, changes={1: at_1}.get)
    sent = rig.transport.send

    def send(tick: int, rows: Rows) -> None:
        seen.append((tick, dict(rows.changes), 'tune' in rig.log[-1]))
        sent(tick, rows)
    rig.transport.send = send
    rig.run()
    assert [changes for _, changes, _ in seen] == [{}, dict(at_1.actuators), {}]
    assert [line for line in rig.log if 'tune' in line] == ["tune {'supply.pressure_mpa': 10.0}"]


def test_a_tick_waits_for_its_commands():
    """Requests and the inputs of actuators are served meanwhile, with the sample of the tick."""
    rig = Rig(2)
    rig.source.waits = {1: 2}
    rig.run()
    start = rig.log.index('no command 1 position=1')
    assert rig.log[start:start + 5] == [
        'no command 1 position=1', 'inputs', 'no command 1 position=1', 'inputs',
        'clock 2000000']
    assert rig.looks == 2 + 2 + 1
    assert rig.sequences == [0, 1, 2]


def test_a_step_waits_for_the_commands_of_each_tick():
    rig = Rig(3, is_paused=True)
    rig.source.waits = {0: 1, 1: 1}
    rig.asked = {0: lambda run: run.step(2), 2: lambda run: run.pause(False)}
    rig.run()
    assert rig.sequences == [0, 1, 2, 3]
    assert rig.log.index('no command 1 position=1') < rig.log.index('idle')


def test_a_stop_ends_the_wait_for_commands():
    rig = Rig(3)
    rig.source.waits, rig.stops_at = {1: 1_000_000}, 1
    with pytest.raises(Interrupted, match='after 1 ticks'):
        rig.run()
    assert rig.sequences == [0, 1]


def test_events_of_the_source_are_recorded_at_their_tick():
    rig = Rig(3)
    rig.source.happened = {2: 'bus lost'}
    rig.run()
    assert rig.events == {2: ['bus lost']}


def test_the_source_sees_what_is_tuned():
    """After the tick at whose start it changed, and only then."""
    rig = Rig(3)
    rig.run()
    assert rig.source.told == {rig.log.index('receive 1') + 1: {1: {'force.kp': 1e-7}}}


def test_the_source_has_the_last_samples():
    rig = Rig(3)
    rig.run()
    assert rig.source.ended == (3, 3.0)


def test_host_time_before_the_first_tick_does_not_count():
    """A minute passes before the first commands: the run is not behind its pace then."""
    host = [0.0]

    def sleep(seconds: float) -> None:
        host[0] += seconds
    pace = Pace(1.0, lambda: host[0], sleep)
    rig = Rig(2, pace=pace)
    rig.source.waits = {0: 1}

    def wait_a_minute(coordinator: Coordinator) -> None:
        host[0] += 60.0
    rig.asked = {0: wait_a_minute, 1: wait_a_minute}
    rig.run()
    assert pace.shortfall is None
