"""Both ends of the private wire: a coordinator's transport and participants on threads."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
import threading

from isa_ros.coordinator import Interrupted, Messages
from isa_ros.errors import ConfigError, RunError, SimulationDiverged
from isa_ros.nodes import Participant, waiting
from isa_ros.nodes.lockstep import Expected, Limits, LockstepTransport
from isa_ros.nodes.wire import encode_tick
from isa_ros.signals import COMMAND, LOAD_PORT, LOAD_REPLY
from isa_ros.stepping import START
import numpy as np
import pytest
from rclpy.node import Node
from tests.ros.started import DEADLINE_S, wait_for

pytestmark = pytest.mark.ros
LIMITS = Limits(join_s=DEADLINE_S, tick_s=0.3)
NAMES = ('haa', 'kfe')


class Scripted:
    """A participant that answers what it was asked."""

    def __init__(self, digest: str = 'same') -> None:
        self.digest = digest
        self.reply = np.zeros(1, LOAD_REPLY)[0]
        self.starts = 0
        self.ticks: list[int] = []
        self.fails_at = -1
        self.is_late_at = -1
        self.released = threading.Event()

    def start(self, start: np.void | None) -> Messages:
        self.starts += 1
        return [b'first' if start is None else b'%g' % start['position'], None]

    def advance(self, tick: int, port: np.void | None, command: np.void | None) -> Messages:
        self.ticks.append(tick)
        if tick == self.fails_at:
            raise SimulationDiverged(7_000_000, 'kfe: spool', float('inf'))
        if tick == self.is_late_at:
            self.released.wait(DEADLINE_S)
        if port is not None and command is not None:
            self.reply['force'] = port['x0'] + command['position']
        return [b'%d' % tick, b'applied' if tick == 1 else None]

    def publish(self, messages: Messages) -> None:
        pass

    def serve(self) -> None:
        pass


@contextmanager
def spinning(context, steppers: dict[str, Scripted]) -> Iterator[None]:
    """Participants of these names while the context lasts."""
    is_over = threading.Event()
    nodes = [Node(name, context=context, enable_rosout=False, start_parameter_services=False)
             for name in steppers]
    threads = [
        threading.Thread(target=Participant(node, stepper).spin, args=(is_over.is_set,))
        for node, stepper in zip(nodes, steppers.values())]
    for thread in threads:
        thread.start()
    try:
        yield
    finally:
        is_over.set()
        for stepper in steppers.values():
            stepper.released.set()
        for thread in threads:
            thread.join()
        for node in nodes:
            node.destroy_node()


def make_transport(
        node: Node, names: Sequence[str] = NAMES, limits: Limits = LIMITS,
        watch: Callable[[], str | None] = lambda: None,
        should_stop: Callable[[], bool] = lambda: False) -> LockstepTransport:
    starts = np.zeros(2, START)
    starts['position'] = 0.25, 0.5
    return LockstepTransport(
        node, [Expected(name, 'same') for name in names], starts, limits,
        lambda messages: None, lambda clock: None, watch=watch, should_stop=should_stop)


def tick(transport: LockstepTransport, number: int) -> tuple[list[float], Sequence[Messages]]:
    """Return (reply forces, messages) of one tick."""
    ports, commands = np.zeros(2, LOAD_PORT), np.zeros(2, COMMAND)
    ports['x0'], commands['position'] = (1.0, 2.0), number
    replies = np.zeros(2, LOAD_REPLY)
    transport.send(number, ports, commands)
    messages = transport.receive(replies)
    return replies['force'].tolist(), messages


@pytest.mark.parametrize('has_handles', [True, False], ids=['wait set', 'executor'])
def test_every_participant_answers_every_tick(observer, monkeypatch, has_handles):
    """Rows go to their actuator, answers come back in the order of the configuration."""
    monkeypatch.setattr(waiting, 'has_handles', lambda: has_handles)
    steppers = {'kfe': Scripted(), 'haa': Scripted()}
    with spinning(observer.context, steppers):
        transport = make_transport(observer)
        assert transport.join() == [[b'0.25', None], [b'0.5', None]]
        assert tick(transport, 0) == ([1.0, 2.0], [[b'0', None], [b'0', None]])
        assert tick(transport, 1) == ([2.0, 3.0], [[b'1', b'applied'], [b'1', b'applied']])
        transport.close()
    assert steppers['haa'].ticks == [0, 1]
    assert steppers['haa'].starts == 1


def test_a_controller_takes_part_without_being_an_actuator(observer):
    """It is waited for at every tick; it has no port, no command and no reply."""
    controller = Scripted(digest='its own')
    steppers = {'haa': Scripted(), 'kfe': Scripted(), 'controller': controller}
    with spinning(observer.context, steppers):
        transport = make_transport(observer, names=NAMES)
        transport._participants = [*transport._participants, Expected('controller', '')]
        assert transport.join()[2] == [b'first', None]
        forces, messages = tick(transport, 0)
        assert forces == [1.0, 2.0]
        assert messages[2] == [b'0', None]


def test_other_digest_is_refused(observer):
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted('other')}):
        with pytest.raises(ConfigError, match='kfe: digest of its parameters = other, must be'):
            make_transport(observer).join()


def test_divergence_arrives_with_its_field(observer):
    """What the actuator raised, the coordinator raises."""
    stepper = Scripted()
    stepper.fails_at = 1
    with spinning(observer.context, {'haa': Scripted(), 'kfe': stepper}):
        transport = make_transport(observer)
        transport.join()
        tick(transport, 0)
        with pytest.raises(SimulationDiverged) as raised:
            tick(transport, 1)
    error = raised.value
    assert (error.t_ns, error.field, error.value) == (7_000_000, 'kfe: spool', float('inf'))


def test_late_participant_is_named(observer):
    stepper = Scripted()
    stepper.is_late_at = 1
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        transport = make_transport(observer)
        transport.join()
        tick(transport, 0)
        with pytest.raises(RunError, match=r'^haa: no answer to tick 1 after 0\.[34] s'):
            tick(transport, 1)


def test_lost_participant_is_named_before_its_timeout(observer):
    stepper, lost = Scripted(), []
    stepper.is_late_at = 0
    limits = Limits(join_s=DEADLINE_S, tick_s=DEADLINE_S)
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        transport = make_transport(
            observer, limits=limits, watch=lambda: lost[0] if lost else None)
        transport.join()
        lost.append('haa: its process 1 was ended by SIGKILL')
        with pytest.raises(RunError, match='SIGKILL in tick 0'):
            tick(transport, 0)


def test_stop_does_not_wait_for_the_timeout(observer):
    stepper, is_stopped = Scripted(), threading.Event()
    stepper.is_late_at = 0
    limits = Limits(join_s=DEADLINE_S, tick_s=DEADLINE_S)
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        transport = make_transport(observer, limits=limits, should_stop=is_stopped.is_set)
        transport.join()
        is_stopped.set()
        with pytest.raises(Interrupted, match='tick 0, which haa did not end'):
            tick(transport, 0)


def test_busy_participant_refuses_another_coordinator(observer):
    """Bound to a run, it is stepped by no one else, and the other is told."""
    steppers = {'haa': Scripted(), 'kfe': Scripted()}
    with spinning(observer.context, steppers):
        first = make_transport(observer)
        first.join()
        tick(first, 0)
        with pytest.raises(ConfigError, match='another coordinator runs in ROS_DOMAIN_ID'):
            make_transport(observer).join()
        assert tick(first, 1)[0] == [2.0, 3.0]
    assert steppers['haa'].starts == 1


def test_a_skipped_tick_is_refused(observer):
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted()}):
        transport = make_transport(observer)
        transport.join()
        with pytest.raises(RunError, match='refused tick 1: tick 1 came, 0 was due'):
            tick(transport, 1)


def test_steps_of_a_strange_run_are_ignored(observer):
    """A step with another run's id neither moves nor unbinds a participant."""
    stepper = Scripted()
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        transport = make_transport(observer)
        transport.join()
        stranger = make_transport(observer)
        wait_for(lambda: stranger._publisher.get_subscription_count() >= 2, 'the match')
        stranger._send(encode_tick(
            stranger._run_id, 0, np.zeros(2, LOAD_PORT), np.zeros(2, COMMAND)))
        stranger.close()
        assert tick(transport, 0)[0] == [1.0, 2.0]
    assert stepper.ticks == [0]


def test_a_second_node_of_a_name_is_noticed_during_the_run(observer):
    """One that was discovered too late for any hello gives its name at its first tick."""
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted()}):
        transport = make_transport(observer)
        transport.join()
        tick(transport, 0)
        with spinning(observer.context, {'kfe': Scripted()}):
            wait_for(lambda: transport._publisher.get_subscription_count() >= 3, 'the match')

            def ticks() -> None:
                for number in range(1, 100_000):
                    tick(transport, number)
            with pytest.raises(ConfigError, match='kfe: two nodes of this name answer'):
                ticks()


def test_a_node_of_another_name_does_not_disturb(observer):
    """It gives its name too, which is none of the run."""
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted(), 'hfe': Scripted()}):
        transport = make_transport(observer)
        transport.join()
        wait_for(lambda: transport._publisher.get_subscription_count() >= 3, 'the match')
        for number in range(200):
            tick(transport, number)


def test_a_participant_serves_one_run_after_the_other(observer):
    stepper = Scripted()
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        for _ in range(2):
            transport = make_transport(observer)
            transport.join()
            assert tick(transport, 0)[0] == [1.0, 2.0]
            transport.close()
    assert stepper.starts == 2
    assert stepper.ticks == [0, 0]
