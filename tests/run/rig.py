"""A coordinator with fakes for actuators, surroundings, commands and recorder."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from isa_ros.core.saved_state import RunState
from isa_ros.core.signals import HAS_SETPOINT, Records
from isa_ros.run.coordinator import Coordinator
from isa_ros.run.outlets import Outlets
from isa_ros.run.output import packer_of, RunOutput
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
