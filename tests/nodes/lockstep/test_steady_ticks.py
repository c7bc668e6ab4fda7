"""What a node does between the ticks of its compiled loop."""

from collections.abc import Callable, Iterator
import os

from isa_ros.core.kernel import IS_COMPILED
from isa_ros.core.signals import COMMAND, HAS_SETPOINT
from isa_ros.nodes.lockstep import steady_ticks as module
from isa_ros.nodes.lockstep.sockets import LARGEST
from isa_ros.nodes.lockstep.steady_ticks import SteadyTicks
from isa_ros.run.wire.answer_loop import _DONE
from isa_ros.run.wire.answering import Ended
from isa_ros.run.wire.answers import decode_answer
from isa_ros.run.wire.board import are_possible, new_board, no_board
from isa_ros.run.wire.steps import decode_step
import numpy as np
import pytest
from tests.run.answer_bench import Bench, closed, encoded, INDEX, N
from tests.run.boards import post_on, ring_actuators

pytestmark = pytest.mark.skipif(not IS_COMPILED, reason='the loop is machine code')


class Quiet:
    """A node, its role and its wire, that count what they are asked to do."""

    def __init__(self, bench: Bench) -> None:
        self.actuator, self.has_feed, self.number = bench.actuator, False, bench.end.fileno()
        self.index, self.board = INDEX, no_board()
        self.watched = False
        self.served = 0
        self.published: list[object] = []
        self.news = False
        self.on_serve: Callable[[], None] = lambda: None

    @property
    def is_settled(self) -> bool:
        return self.actuator.is_settled

    def take(self) -> bytes:
        return b'by socket'

    def is_watched(self) -> bool:
        return self.watched

    def serve(self) -> None:
        self.served += 1
        self.on_serve()

    def has_news(self, n: int, keeps: bool) -> bool:
        self.published.append((n, keeps))
        return self.news

    def publish_last(self) -> None:
        self.published.append('last')

    def publish_commands(self, commands) -> None:
        self.published.append([(t_ns // 1_000_000, own['position']) for t_ns, own in commands])

    def parts(self) -> list[bytes]:
        return [b'parts']


@pytest.fixture
def bench() -> Iterator[Bench]:
    made = Bench()
    yield made
    closed(made)


@pytest.fixture
def node(bench, monkeypatch) -> Quiet:
    monkeypatch.setattr(module, 'QUIET_NS', 10**12)
    return Quiet(bench)


@pytest.fixture
def ticks(node) -> SteadyTicks:
    made = SteadyTicks(node, node)
    assert not made.are_next
    made.expect(decode_step(encoded(4)), INDEX)
    return made


def send(bench: Bench, *ticks: int) -> None:
    for tick in ticks:
        bench.coordinator.send(encoded(tick))


def test_nothing_is_looked_at_until_it_is_due(bench, node, ticks, monkeypatch):
    monkeypatch.setattr(module, 'MOST', 20)
    send(bench, *range(5, 27))
    assert ticks.run(node, 5) is Ended.ANSWERED and ticks.done == 20
    assert node.served == 1     # before the first tick
    assert ticks.run(node, 25) is Ended.NOTHING and ticks.done == 2
    assert node.served == 1
    monkeypatch.setattr(module, 'QUIET_NS', 0)
    ticks._due_ns = 0
    send(bench, 30)
    assert ticks.run(node, 30) is Ended.DUE and ticks.done == 0 and ticks.has_step
    assert ticks.run(node, 30) is Ended.DUE
    assert node.served == 3


def test_a_step_that_was_due_after_other_ticks_is_the_next_one(bench, node, ticks, monkeypatch):
    send(bench, 5)
    ticks.run(node, 5)
    send(bench, 6)
    run, ended = ticks._loop.run, [Ended.DUE]
    monkeypatch.setattr(ticks._loop, 'run', lambda *given: ended.pop() if ended else run(*given))
    assert ticks.run(node, 6) is Ended.DUE and ticks.done == 1     # of the call before
    assert ticks.run(node, 6) is Ended.NOTHING and ticks.done == 1 and node.served == 2


def test_while_somebody_listens_every_tick_is_looked_at(bench, node, ticks):
    """A setpoint that has come before the step takes effect at it."""
    node.watched = True
    send(bench, 5, 6, 7)
    answers = []
    command = np.zeros(1, COMMAND)[0]
    command['kinds'], command['position'] = HAS_SETPOINT, 0.017
    for tick in (5, 6, 7):
        node.on_serve = (lambda: bench.actuator.accept(command)) if tick == 6 else lambda: None
        assert ticks.run(node, tick) is Ended.ANSWERED and ticks.done == 1
        assert node.served == tick - 4
        ticks.end()
        answers.append(decode_answer(bench.coordinator.recv(LARGEST)))
    kinds = [np.frombuffer(own.parts[0], COMMAND, 1, 504)[0]['kinds'] for own in answers]
    assert kinds == [0, HAS_SETPOINT, 0]
    node.watched = False
    send(bench, 8, 9, 10)
    ticks.run(node, 8)
    assert ticks.done == 2 + 1 and node.served == 4


def test_a_tick_that_changes_a_parameter_is_left(bench, node, ticks):
    send(bench, 5)
    node.on_serve = lambda: bench.actuator.tune({'force.kp': 9e-8})
    assert ticks.run(node, 5) is Ended.OTHER and ticks.done == 0
    assert not ticks.are_next and ticks.has_step
    assert ticks.take_step() == encoded(5) and not ticks.has_step


def test_a_change_before_a_step_that_waits_leaves_it_alone(bench, node, ticks, monkeypatch):
    """The ticks before it are not counted twice."""
    send(bench, 5)
    ticks.run(node, 5)
    ticks._due_ns = 0
    ticks._is_due = True    # as after ticks that took their time
    send(bench, 6)
    assert ticks._loop.run(node.number, 6, 0, 1, True) is Ended.DUE
    ticks._loop._values[_DONE] = 4
    node.on_serve = lambda: bench.actuator.tune({'force.kp': 9e-8})
    assert ticks.run(node, 6) is Ended.OTHER and ticks.done == 0
    assert ticks.take_step() == encoded(6)


def test_the_time_goes_on_with_the_ticks(bench, node, ticks):
    t_ns = bench.actuator.t_ns
    send(bench, 5, 6, 7)
    ticks.run(node, 5)
    ticks.end()
    assert ticks.parts() == [b'parts'] and bench.actuator.t_ns == t_ns + 3_000_000
    ticks.publish()
    assert node.published == [(3, True)]


def commanded(bench: Bench, node: Quiet, ticks: SteadyTicks, **targets: float) -> None:
    """Answer ticks 5, 6, ... with commands, and let the node publish."""
    for k in range(5, 9):
        bench.coordinator.send(encoded(k, target=targets.get(f'at_{k}')))
    assert ticks.run(node, 5) is Ended.NOTHING and ticks.done == 4
    ticks.end()
    ticks.publish()


def test_applied_setpoints_are_published_after_a_while(bench, node, ticks):
    """Without a subscription: the first at once, the next ones together."""
    commanded(bench, node, ticks, at_6=0.021)
    t = bench.actuator.t_ns // 1_000_000
    assert node.published == [(4, True), [(t - 2, 0.021)]]
    node.published.clear()
    commanded(bench, node, ticks, at_5=0.022, at_8=0.023)
    assert node.published == [(4, True)]
    ticks._kept_due_ns = 0
    commanded(bench, node, ticks, at_7=0.024)
    assert node.published[2:] == [[(t + 1, 0.022), (t + 4, 0.023), (t + 7, 0.024)]]
    ticks.publish_kept()
    assert len(node.published) == 3


def test_what_is_kept_is_published_before_all_else(bench, node, ticks):
    """The message of the last tick has its own command."""
    ticks._kept_due_ns = 2**62
    commanded(bench, node, ticks, at_5=0.021, at_6=0.022)
    assert node.published == [(4, True)]
    node.news = True
    t = bench.actuator.t_ns // 1_000_000
    commanded(bench, node, ticks, at_7=0.023, at_8=0.024)
    assert node.published[1:] == [
        (4, True), [(t - 3, 0.021), (t - 2, 0.022), (t + 3, 0.023)], 'last']
    node.published.clear()
    commanded(bench, node, ticks, at_8=0.025)
    assert node.published == [(4, True), 'last']


def test_setpoints_are_published_where_there_is_no_more_room(bench, node, ticks, monkeypatch):
    ticks._kept_due_ns = 2**62
    monkeypatch.setattr(module, 'MOST_KEPT', 2)
    commanded(bench, node, ticks, at_5=0.021)
    assert len(node.published) == 1
    commanded(bench, node, ticks, at_5=0.022)
    assert len(node.published) == 3


def test_after_something_else_a_step_is_checked_first(bench, node, ticks):
    assert ticks.are_next
    ticks.forget()
    assert not ticks.are_next


def test_behind_a_link_commands_are_not_kept():
    """They take effect at frames, and have messages when sent and when applied."""
    bench = Bench(is_linked=True)
    node = Quiet(bench)
    ticks = SteadyTicks(node, node)
    ticks.expect(decode_step(encoded(4)), INDEX)
    send(bench, 5)
    ticks.run(node, 5)
    ticks.publish()
    assert node.published == [(1, False)]
    closed(bench)


def test_what_is_not_for_the_loop_is_waited_for_too(bench, node, ticks):
    """A step as it came; without one, what is at the socket."""
    send(bench, 5, 6)
    assert [ticks.wait(node), ticks.wait(node)] == [encoded(5), encoded(6)]
    assert ticks.wait(node) == b'by socket' and not ticks.has_step
    assert node.served == 0


@pytest.mark.skipif(not are_possible(), reason='a board needs Linux')
def test_it_waits_at_the_board_that_its_wire_has_brought(bench, node, ticks):
    """At the slot of its row; at another wire's once it has that."""
    node.board, file = new_board(N, LARGEST)
    os.close(file)
    for tick in 5, 6:
        post_on(node.board, encoded(tick))
        assert ticks.run(node, tick) in (Ended.NOTHING, Ended.ANSWERED) and ticks.done == 1
    assert node.board.slots['is_there'].tolist() == [0, 1, 0]
    post_on(node.board, encoded(7))
    assert ticks.wait(node) == encoded(7)
    ring_actuators(node.board)
    assert ticks.wait(node) == b'by socket'
    node.ring()
    assert node.board.head['rings'][0] > 0
    other = Quiet(bench)
    send(bench, 7)
    assert ticks.wait(other) == encoded(7)
