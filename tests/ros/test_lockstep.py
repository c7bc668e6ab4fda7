"""Both ends of the private wire: a coordinator's transport and participants on threads."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
import threading
import time

from isa_ros.controller import Controller, Setpoint
from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_SETPOINT, LOAD_REPLY, SAMPLE, START
from isa_ros.errors import ConfigError, RunError, SetpointError, SimulationDiverged
from isa_ros.nodes.lockstep import (
    coordinator_end as lockstep, participant_end, sockets as local_wire)
from isa_ros.nodes.lockstep.coordinator_end import LockstepTransport
from isa_ros.nodes.lockstep.expected import Expected, Limits, Participants
from isa_ros.nodes.lockstep.participant_end import ParticipantEnd
from isa_ros.nodes.lockstep.roles import ActuatorRole, ControllerRole
from isa_ros.nodes.middleware import mailboxes, servers
from isa_ros.run.coordinator import Interrupted
from isa_ros.run.exchange import Rows
from isa_ros.run.wire.cast import Cast
from isa_ros.run.wire.steps import encode_tick
from isa_ros.surroundings.supply import SUPPLY_SAMPLE
import numpy as np
import pytest
from rclpy.node import Node
from tests.ros.started import wait_for

pytestmark = pytest.mark.ros
DEADLINE_S = 20.0  # without processes to start and kernels to compile
PATIENT = Limits(join_s=DEADLINE_S, tick_s=DEADLINE_S)
NAMES = ('haa', 'kfe')


@pytest.fixture(params=['sockets', 'topics'], autouse=True)
def carrier(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Return the transport of the ticks: sockets on one host."""
    if request.param == 'topics':
        monkeypatch.setattr(local_wire, 'is_possible', lambda: False)
    return request.param


class Cart:
    """A body of which only its sample matters."""

    sample = np.zeros(1, [('height', '<f8')])


class Outside:
    """Surroundings of which only what they show matters."""

    def __init__(self, has_body: bool) -> None:
        self.supplies = np.zeros(1, SUPPLY_SAMPLE)
        self.body = Cart() if has_body else None


def rows_of_two(has_body: bool = False) -> Rows:
    """Return the memory of a run of `NAMES`."""
    return Rows(2, Outside(has_body))


class Scripted:
    """An actuator that returns the received values; its position counts its ticks."""

    def __init__(self, digest: str = 'same') -> None:
        self.digest = digest
        self.reply, self.sample = np.zeros(1, LOAD_REPLY), np.zeros(1, SAMPLE)
        self.applied = np.zeros(1, COMMAND)
        self.tuned: Mapping[str, float] = {}
        self.starts = 0
        self.ticks = 0
        self.published: list[float] = []
        self.fails_at = -1
        self.error: Exception = SimulationDiverged(7_000_000, 'kfe: spool', float('inf'))
        self.is_late_at = -1
        self.released = threading.Event()
        self.pause_s = 0.0

    def start(self, start: np.void | None) -> None:
        assert start is not None
        self.starts += 1
        self.ticks = 0
        self.sample['position'] = start['position']
        self._apply(HAS_SETPOINT | HAS_ENABLE, {})

    def advance(self, port: np.void | None, command: np.void | None) -> None:
        tick, self.ticks = self.ticks, self.ticks + 1
        if tick == self.fails_at:
            raise self.error
        time.sleep(self.pause_s)
        if tick == self.is_late_at:
            self.released.wait(DEADLINE_S)
        if port is not None and command is not None:
            self.reply['force'] = port['x0'] + command['position']
        self.sample['position'] += 1.0
        self._apply(*(HAS_SETPOINT, {'force.kp': 1e-7}) if tick == 1 else (0, {}))

    def _apply(self, kinds: int, tuned: Mapping[str, float]) -> None:
        self.applied['kinds'], self.applied['position'] = kinds, self.sample['position']
        self.tuned = tuned

    def snapshot(self) -> bytes:
        time.sleep(self.pause_s)
        return b'after %d' % self.ticks

    def restore(self, snapshot: bytes) -> None:
        self.ticks = int(snapshot.split()[1])
        self.sample['position'] = 100.0 + self.ticks
        self._apply(HAS_ENABLE, {'force.kf': float(self.ticks)})

    def publish(self) -> None:
        self.published.append(float(self.sample['position'][0]))

    def serve(self) -> None:
        pass


@contextmanager
def spinning(context, steppers: dict[str, Scripted | Controller]) -> Iterator[None]:
    """Take part with these names while the context lasts."""
    is_over = threading.Event()
    nodes = [Node(name, context=context, enable_rosout=False, start_parameter_services=False)
             for name in steppers]
    threads = [
        threading.Thread(target=ParticipantEnd(node, role(stepper)).spin, args=(is_over.is_set,))
        for node, stepper in zip(nodes, steppers.values())]
    for thread in threads:
        thread.start()
    try:
        yield
    finally:
        is_over.set()
        for stepper in steppers.values():
            if isinstance(stepper, Scripted):
                stepper.released.set()
        for thread in threads:
            thread.join()
        for node in nodes:
            node.destroy_node()


def role(stepper: Scripted | Controller) -> ActuatorRole | ControllerRole:
    return ActuatorRole(stepper) if isinstance(stepper, Scripted) else ControllerRole(stepper)


def make_transport(
        node: Node, controllers: Sequence[str] = (), limits: Limits = PATIENT,
        watch: Callable[[], str | None] = lambda: None,
        should_stop: Callable[[], bool] = lambda: False, first_remote: int = 0,
        has_body: bool = False) -> LockstepTransport:
    starts = np.zeros(2, START)
    starts['position'] = 0.25, 0.5
    expected = [*(Expected(name, 'same') for name in NAMES),
                *(Expected(name, '') for name in controllers)]
    cast = Cast([own.name for own in expected], ['supply'],
                Cart.sample.dtype if has_body else None)
    return LockstepTransport(
        node, Participants(expected, cast, starts, 1_000_000, first_remote), limits,
        watch=watch, should_stop=should_stop)


def begin(transport: LockstepTransport, rows: Rows | None = None) -> Rows:
    """Return the rows before tick 0."""
    rows = rows_of_two() if rows is None else rows
    transport.join(rows)
    transport.begin()
    return rows


def tick(
        transport: LockstepTransport, number: int, rows: Rows | None = None) -> list[float]:
    """Return the reply forces of one tick."""
    rows = rows_of_two() if rows is None else rows
    rows.ports['x0'], rows.commands['position'] = (1.0, 2.0), number
    transport.send(number, rows)
    transport.receive(rows)
    return rows.replies['force'].tolist()


def applied(rows: Rows) -> list[tuple[int, float]]:
    """Return (kinds, position) of what took effect at each actuator."""
    return list(zip(rows.applied['kinds'].tolist(), rows.applied['position'].tolist()))


@pytest.mark.parametrize('has_handles', [True, False], ids=['wait set', 'executor'])
def test_every_participant_answers_every_tick(observer, monkeypatch, has_handles):
    """Rows go to their actuator, answers come back in the order of the configuration."""
    for module in (mailboxes, servers):
        monkeypatch.setattr(module, 'has_handles', lambda: has_handles)
    steppers = {'kfe': Scripted(), 'haa': Scripted()}
    with spinning(observer.context, steppers):
        transport = make_transport(observer)
        rows = begin(transport)
        assert rows.samples['position'].tolist() == [0.25, 0.5]
        first = HAS_SETPOINT | HAS_ENABLE
        assert applied(rows) == [(first, 0.25), (first, 0.5)]
        assert rows.tuned == {}
        assert tick(transport, 0, rows) == [1.0, 2.0]
        assert rows.samples['position'].tolist() == [1.25, 1.5]
        assert [kinds for kinds, _ in applied(rows)] == [0, 0] and rows.tuned == {}
        assert tick(transport, 1, rows) == [2.0, 3.0]
        assert applied(rows) == [(HAS_SETPOINT, 2.25), (HAS_SETPOINT, 2.5)]
        assert rows.tuned == {0: {'force.kp': 1e-7}, 1: {'force.kp': 1e-7}}
        tick(transport, 2, rows)
        assert [kinds for kinds, _ in applied(rows)] == [0, 0] and rows.tuned == {}
        transport.close()
    assert steppers['haa'].ticks == 3
    assert steppers['haa'].starts == 1


class Follower(Controller):
    """Commands HAA to the position of KFE, and keeps the states it received."""

    def __init__(self) -> None:
        self.shown: list[tuple[int, list[float]]] = []
        self.supplies: list[dict[str, float]] = []
        self.heights: list[float | None] = []
        self.setpoints: dict[str, Setpoint] | None = None

    def start(self, names: Sequence[str]) -> None:
        self.names = list(names)

    def step(self, state) -> dict[str, Setpoint]:
        positions = [float(own.position) for own in state.actuators.values()]
        self.shown.append((state.t_ns, positions))
        self.supplies.append({name: float(own.pressure) for name, own in state.supplies.items()})
        self.heights.append(None if state.body is None else float(state.body.height))
        return {'haa': Setpoint(positions[1])} if self.setpoints is None else self.setpoints


def test_a_controller_sees_tick_k_and_speaks_for_tick_k_plus_1(observer):
    """It receives the samples before the tick, and the run waits for its answer."""
    controller, rows = Follower(), rows_of_two()
    steppers = {'haa': Scripted(), 'kfe': Scripted(), 'follower': controller}
    with spinning(observer.context, steppers):
        transport = make_transport(observer, ['follower'])
        begin(transport, rows)
        assert rows.requests['kinds'].tolist() == [0, 0]
        assert rows.samples['position'].tolist() == [0.25, 0.5]
        tick(transport, 0, rows)
        assert rows.samples['position'].tolist() == [1.25, 1.5]
        assert rows.requests['kinds'].tolist() == [HAS_SETPOINT, 0]
        assert rows.requests['position'][0] == 0.5
        tick(transport, 1, rows)
        assert rows.requests['position'][0] == 1.5
    assert controller.names == ['haa', 'kfe']
    assert controller.shown == [(0, [0.25, 0.5]), (1_000_000, [1.25, 1.5])]


@pytest.mark.parametrize('has_body', [False, True])
def test_a_controller_receives_supplies_and_body(observer, has_body):
    """As they are before the tick; the body by the fields of its own record type."""
    controller, rows = Follower(), rows_of_two(has_body)
    steppers = {'haa': Scripted(), 'kfe': Scripted(), 'follower': controller}
    with spinning(observer.context, steppers):
        transport = make_transport(observer, ['follower'], has_body=has_body)
        begin(transport, rows)
        for number in range(2):
            rows.supplies['pressure'] = 20e6 - number
            if rows.body is not None:
                rows.body['height'] = 0.5 + number
            tick(transport, number, rows)
    assert controller.supplies == [{'supply': 20e6}, {'supply': 20e6 - 1.0}]
    assert controller.heights == ([0.5, 1.5] if has_body else [None, None])


def test_a_setpoint_for_an_unknown_actuator_ends_the_run(observer):
    controller = Follower()
    controller.setpoints = {'hip': Setpoint(0.1)}
    with spinning(observer.context, {
            'haa': Scripted(), 'kfe': Scripted(), 'follower': controller}):
        transport = make_transport(observer, ['follower'])
        begin(transport)
        with pytest.raises(RunError, match="follower: refused tick 0: 'hip' is not an actuator"):
            tick(transport, 0)


def test_what_a_participant_raises_reaches_the_coordinator(observer):
    """After a refusal the participant continues; the coordinator's run ends."""
    stepper = Scripted()
    stepper.fails_at, stepper.error = 1, SetpointError('kfe: no such thing')
    with spinning(observer.context, {'haa': Scripted(), 'kfe': stepper}):
        transport = make_transport(observer)
        begin(transport)
        tick(transport, 0)
        with pytest.raises(RunError, match='kfe: refused tick 1: kfe: no such thing'):
            tick(transport, 1)


def test_nothing_is_published_before_the_clock(observer):
    """The first messages are held until `begin`, when `/clock` has been published."""
    stepper = Scripted()
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        transport = make_transport(observer)
        transport.join(rows_of_two())
        assert stepper.published == []
        transport.begin()
        tick(transport, 0)
        wait_for(lambda: len(stepper.published) == 2, 'both messages')
    assert stepper.published == [0.25, 1.25]


def test_a_saved_state_is_restored(observer):
    """Every participant saves and restores its own state; the tick number continues too."""
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted()}):
        transport = make_transport(observer)
        begin(transport)
        tick(transport, 0)
        tick(transport, 1)
        states = transport.snapshots()
        assert states == [b'after 2', b'after 2']
        rows = rows_of_two()
        transport.join(rows)
        transport.restore(2, [b'after 2', b'after 7'], rows)
        assert rows.samples['position'].tolist() == [102.0, 107.0]
        assert applied(rows) == [(HAS_ENABLE, 102.0), (HAS_ENABLE, 107.0)]
        assert rows.tuned == {0: {'force.kf': 2.0}, 1: {'force.kf': 7.0}}
        transport.begin()
        tick(transport, 2, rows)
        assert rows.samples['position'].tolist() == [103.0, 108.0]
        assert rows.tuned == {}


def test_a_controller_without_snapshot_is_named(observer):
    with spinning(observer.context, {
            'haa': Scripted(), 'kfe': Scripted(), 'follower': Follower()}):
        transport = make_transport(observer, ['follower'])
        begin(transport)
        with pytest.raises(RunError, match=(
                r'follower: refused the request to save its state: Follower has no snapshot\(\)')):
            transport.snapshots()


def test_only_those_in_other_processes_are_called(observer):
    """Actuators in the coordinator's own process answer it directly."""
    with spinning(observer.context, {'follower': Follower()}):
        transport = make_transport(observer, ['follower'], first_remote=2)
        rows = rows_of_two()
        rows.samples['position'], rows.tuned = (0.75, 0.5), {0: {'force.kp': 1e-7}}
        rows.applied['kinds'] = HAS_ENABLE
        begin(transport, rows)
        tick(transport, 0, rows)
        assert rows.requests['kinds'].tolist() == [HAS_SETPOINT, 0]
        assert rows.requests['position'][0] == 0.5
        # What the actuators have said themselves stays.
        assert rows.samples['position'].tolist() == [0.75, 0.5]
        assert rows.tuned == {0: {'force.kp': 1e-7}}
        assert rows.applied['kinds'].tolist() == [HAS_ENABLE, HAS_ENABLE]


def test_a_node_with_the_name_of_one_in_this_process_is_refused(observer):
    with spinning(observer.context, {'follower': Follower(), 'haa': Scripted()}):
        with pytest.raises(ConfigError, match='haa: two nodes of this name answer'):
            make_transport(observer, ['follower'], first_remote=2).join(rows_of_two())


def test_other_digest_is_refused(observer):
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted('other')}):
        with pytest.raises(ConfigError, match='kfe: digest of its parameters = other, must be'):
            make_transport(observer).join(rows_of_two())


def test_divergence_arrives_with_its_field(observer):
    """The coordinator raises the error that the actuator raised."""
    stepper = Scripted()
    stepper.fails_at = 1
    with spinning(observer.context, {'haa': Scripted(), 'kfe': stepper}):
        transport = make_transport(observer)
        begin(transport)
        tick(transport, 0)
        with pytest.raises(SimulationDiverged) as raised:
            tick(transport, 1)
    error = raised.value
    assert (error.t_ns, error.field, error.value) == (7_000_000, 'kfe: spool', float('inf'))


def test_late_participant_is_named(observer):
    stepper = Scripted()
    stepper.is_late_at = 1
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        transport = make_transport(observer, limits=Limits(join_s=DEADLINE_S, tick_s=0.3))
        begin(transport)
        tick(transport, 0)
        with pytest.raises(RunError, match=r'^haa: no answer to tick 1 after 0\.[34] s'):
            tick(transport, 1)


def test_lost_participant_is_named_before_its_timeout(observer):
    stepper, lost = Scripted(), []
    stepper.is_late_at = 0
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        transport = make_transport(observer, watch=lambda: lost[0] if lost else None)
        begin(transport)
        lost.append('haa: its process 1 was ended by SIGKILL')
        with pytest.raises(RunError, match='SIGKILL in tick 0'):
            tick(transport, 0)


def test_stop_does_not_wait_for_the_timeout(observer):
    stepper, is_stopped = Scripted(), threading.Event()
    stepper.is_late_at = 0
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        transport = make_transport(observer, should_stop=is_stopped.is_set)
        begin(transport)
        is_stopped.set()
        with pytest.raises(Interrupted, match='tick 0, which haa did not end'):
            tick(transport, 0)


def test_busy_participant_refuses_another_coordinator(observer):
    """A participant bound to a run accepts steps of that run only and refuses the other."""
    steppers = {'haa': Scripted(), 'kfe': Scripted()}
    with spinning(observer.context, steppers):
        first = make_transport(observer)
        begin(first)
        tick(first, 0)
        with pytest.raises(ConfigError, match='another coordinator runs in ROS_DOMAIN_ID'):
            make_transport(observer).join(rows_of_two())
        assert tick(first, 1) == [2.0, 3.0]
    assert steppers['haa'].starts == 1


def is_followed(transport: LockstepTransport) -> bool:
    """Try to begin a run; return whether the participants take part."""
    try:
        begin(transport)
    except ConfigError:
        return False
    return True


def test_participants_of_a_silent_coordinator_follow_another(observer, monkeypatch):
    """A killed coordinator stays in the middleware's graph for a while."""
    monkeypatch.setattr(participant_end, 'SILENCE_S', 0.2)
    steppers = {'haa': Scripted(), 'kfe': Scripted()}
    with spinning(observer.context, steppers):
        first, second = make_transport(observer), make_transport(observer)
        begin(first)
        tick(first, 0)
        wait_for(lambda: is_followed(second), 'the silence')
        assert tick(second, 0) == [1.0, 2.0]
    assert steppers['haa'].starts >= 2  # again where the other had still refused


def test_a_paused_coordinator_is_not_silent(observer, monkeypatch):
    monkeypatch.setattr(participant_end, 'SILENCE_S', 0.3)
    monkeypatch.setattr(lockstep, 'REPEAT_S', 0.02)
    steppers = {'haa': Scripted(), 'kfe': Scripted()}
    with spinning(observer.context, steppers):
        first, second = make_transport(observer), make_transport(observer)
        begin(first)
        end = time.monotonic() + 2.0 * participant_end.SILENCE_S
        while time.monotonic() < end:
            first.idle()
        assert not is_followed(second)
        assert tick(first, 0) == [1.0, 2.0]
    assert steppers['haa'].starts == 1


def test_a_skipped_tick_is_refused(observer):
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted()}):
        transport = make_transport(observer)
        begin(transport)
        with pytest.raises(RunError, match='refused tick 1: tick = 1, must be 0'):
            tick(transport, 1)


def test_steps_of_a_strange_run_are_ignored(observer):
    """A step with another run's id neither moves nor unbinds a participant."""
    stepper = Scripted()
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        transport = make_transport(observer)
        begin(transport)
        stranger = make_transport(observer)
        wait_for(lambda: stranger._publisher.get_subscription_count() >= 2, 'the match')
        stranger._send(encode_tick(7, 0, rows_of_two(), False))
        stranger.close()
        assert tick(transport, 0) == [1.0, 2.0]
    assert stepper.ticks == 1


def test_a_second_node_of_a_name_is_noticed_during_the_run(observer):
    """A node discovered too late for any hello gives its name at its first tick."""
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted()}):
        transport = make_transport(observer)
        begin(transport)
        tick(transport, 0)
        with spinning(observer.context, {'kfe': Scripted()}):
            wait_for(lambda: transport._publisher.get_subscription_count() >= 3, 'the match')

            def ticks() -> None:
                for number in range(1, 100_000):
                    tick(transport, number)
            with pytest.raises(ConfigError, match='kfe: two nodes of this name answer'):
                ticks()


def dropping(send: Callable[[bytes], object]) -> Callable[[bytes], bool]:
    """Lose the first message, as if the middleware had dropped the participant for a while."""
    messages: list[bytes] = []

    def send_but_the_first(message: bytes) -> bool:
        if messages:
            send(message)
        messages.append(message)
        return True
    return send_but_the_first


def drop_next(end: LockstepTransport | ParticipantEnd, carrier: str) -> None:
    """Lose the next message that this end sends."""
    wire = end._wires if isinstance(end, LockstepTransport) else end._wire
    assert is_by_socket(end) == (carrier == 'sockets')
    if carrier == 'sockets':
        wire.send = dropping(wire.send)
    else:
        end._send = dropping(end._send)


def is_by_socket(end: LockstepTransport | ParticipantEnd) -> bool:
    """Return whether this end sends its ticks or answers by socket."""
    return end._wires.is_open if isinstance(end, LockstepTransport) else end._wire is not None


def test_a_lost_step_is_asked_for_again(observer, carrier):
    stepper = Scripted()
    with spinning(observer.context, {'haa': Scripted(), 'kfe': stepper}):
        transport = make_transport(observer)
        begin(transport)
        drop_next(transport, carrier)
        assert tick(transport, 0) == [1.0, 2.0]
        assert tick(transport, 1) == [2.0, 3.0]
    assert stepper.ticks == 2


@pytest.fixture
def ends(monkeypatch) -> list[ParticipantEnd]:
    """Return a list of the participants' ends that are created from now on."""
    made: list[ParticipantEnd] = []
    make = ParticipantEnd.__init__

    def note(self: ParticipantEnd, *arguments: object) -> None:
        make(self, *arguments)
        made.append(self)
    monkeypatch.setattr(ParticipantEnd, '__init__', note)
    return made


def test_a_lost_answer_is_given_again_without_another_tick(observer, ends, carrier):
    """The other participant repeats its answer too, which does not count as a second node."""
    steppers = {'haa': Scripted(), 'kfe': Scripted()}
    with spinning(observer.context, steppers):
        transport = make_transport(observer)
        begin(transport)
        drop_next(ends[1], carrier)
        for number in range(50):
            assert tick(transport, number) == [1.0 + number, 2.0 + number]
    assert steppers['haa'].ticks == steppers['kfe'].ticks == 50


def test_a_lost_state_is_given_again(observer, ends, carrier):
    """A state is saved once for repeated requests; a later request saves a new one."""
    steppers = {'haa': Scripted(), 'kfe': Scripted()}
    with spinning(observer.context, steppers):
        transport = make_transport(observer)
        begin(transport)
        tick(transport, 0)
        drop_next(ends[0], carrier)
        assert transport.snapshots() == [b'after 1', b'after 1']
        steppers['haa'].ticks = 5
        assert transport.snapshots() == [b'after 5', b'after 1']


def test_a_repeat_that_newer_steps_have_overtaken_is_past(observer, monkeypatch):
    """During a long step of one participant its steps are repeated to all over the topics."""
    monkeypatch.setattr(lockstep, 'REPEAT_S', 0.05)
    slow = Scripted()
    steppers = {'haa': Scripted(), 'kfe': slow}
    with spinning(observer.context, steppers):
        transport = make_transport(observer)
        begin(transport)
        tick(transport, 0)
        slow.pause_s = 0.06
        for number in range(1, 20):
            assert tick(transport, number) == [1.0 + number, 2.0 + number]
            assert transport.snapshots() == [b'after %d' % (number + 1)] * 2
    assert steppers['haa'].ticks == slow.ticks == 20


@pytest.mark.parametrize('closed', [[0], [0, 1]])
def test_without_sockets_the_topics_carry_the_run_on(
        observer, monkeypatch, ends, carrier, closed):
    """No step has to be repeated."""
    monkeypatch.setattr(lockstep, 'REPEAT_S', DEADLINE_S)
    steppers = {'haa': Scripted(), 'kfe': Scripted()}
    with spinning(observer.context, steppers):
        transport = make_transport(observer)
        begin(transport)
        tick(transport, 0)
        assert is_by_socket(transport) == (carrier == 'sockets')
        for k in closed:
            if ends[k]._wire is not None:
                ends[k]._wire.close()
        for number in range(1, 50):
            assert tick(transport, number) == [1.0 + number, 2.0 + number]
        assert not is_by_socket(transport)
        begin(transport)
        assert is_by_socket(transport) == (carrier == 'sockets')
    assert steppers['haa'].starts == 2


def test_steps_too_large_for_sockets_travel_as_topics(observer, monkeypatch, carrier):
    monkeypatch.setattr(local_wire, 'LARGEST', 200)
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted()}):
        transport = make_transport(observer)
        begin(transport)
        assert is_by_socket(transport) == (carrier == 'sockets')
        for number in range(50):
            assert tick(transport, number) == [1.0 + number, 2.0 + number]
        assert not is_by_socket(transport)


def test_a_participant_without_a_socket_keeps_all_on_topics(observer, monkeypatch):
    """The participant is on another host, or belongs to another user."""
    connect = local_wire.LocalWire.to_run
    taken: list[bytes] = []

    def one_only(run_id: int, identity: bytes, slice_s: float) -> local_wire.LocalWire | None:
        taken.append(identity)
        return connect(run_id, identity, slice_s) if len(taken) == 1 else None
    monkeypatch.setattr(local_wire.LocalWire, 'to_run', staticmethod(one_only))
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted()}):
        transport = make_transport(observer)
        begin(transport)
        assert not is_by_socket(transport)
        for number in range(50):
            assert tick(transport, number) == [1.0 + number, 2.0 + number]
    assert len(taken) == 2


def test_a_node_of_another_name_does_not_disturb(observer):
    """It gives its name too, which is not a name of the run."""
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted(), 'hfe': Scripted()}):
        transport = make_transport(observer)
        begin(transport)
        wait_for(lambda: transport._publisher.get_subscription_count() >= 3, 'the match')
        for number in range(200):
            tick(transport, number)


def test_a_participant_serves_one_run_after_the_other(observer):
    stepper = Scripted()
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        for _ in range(2):
            transport = make_transport(observer)
            begin(transport)
            assert tick(transport, 0) == [1.0, 2.0]
            transport.close()
    assert stepper.starts == 2
    assert stepper.ticks == 1
