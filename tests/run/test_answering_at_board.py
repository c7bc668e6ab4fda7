"""The compiled loop of an actuator that waits at the board of its run."""

from collections.abc import Iterator
import os
import time

from isa_ros.core.system_calls import SLICE_NS
from isa_ros.nodes.lockstep.sockets import LARGEST
from isa_ros.run.wire.answering import Ended
from isa_ros.run.wire.board import are_possible, board_of, LOUD, new_board, no_board
from isa_ros.run.wire.steps import encode_save
import pytest
from tests.run.answer_bench import Bench, closed, encoded, INDEX, N, RUN
from tests.run.boards import answer_on, post_on, ring_actuators

pytestmark = pytest.mark.skipif(not are_possible(), reason='a board needs Linux and machine code')


class AtBoard(Bench):
    """The bench, with a board that its coordinator has, too."""

    def __init__(self, has_feed: bool = False, is_linked: bool = False) -> None:
        super().__init__(has_feed, is_linked)
        self.board, file = new_board(N, LARGEST)
        self.loop.stand_at(board_of(file, LARGEST), INDEX)
        os.close(file)

    def post(self, message: bytes) -> None:
        post_on(self.board, message)

    @property
    def answer(self) -> bytes | None:
        return answer_on(self.board, INDEX)


@pytest.fixture
def bench() -> Iterator[AtBoard]:
    made = AtBoard()
    yield made
    closed(made)


def is_silent(bench: AtBoard) -> bool:
    """Return whether nothing was sent by socket."""
    bench.coordinator.settimeout(0.0)
    try:
        return not bench.coordinator.recv(1)
    except BlockingIOError:
        return True


@pytest.mark.parametrize('has_feed', [False, True], ids=['', 'with a feed'])
@pytest.mark.parametrize('is_linked', [False, True], ids=['', 'behind a link'])
def test_an_answer_is_byte_for_byte_that_of_python(has_feed, is_linked):
    """In its own slot, and not by socket."""
    bench = AtBoard(has_feed, is_linked)
    for tick in range(2**33, 2**33 + 20):
        target = 0.012 if tick % 10 == 3 else None
        bench.post(encoded(tick, has_feed=has_feed, target=target))
        assert bench.answer is None
        assert bench.run(tick) is Ended.ANSWERED and bench.loop.done == 1
        assert bench.answer == bench.by_python(tick, target)
        assert bench.board.head['rings'][0] == 1 - N
    assert [int(own) for own in bench.board.slots['answered']] == [0, 20, 0]
    assert is_silent(bench)
    closed(bench)


def test_a_step_is_taken_once(bench):
    """After it, the loop waits for the next one, but not for long."""
    bench.post(encoded(5))
    begin = time.monotonic()
    assert bench.run(5, most=3) is Ended.NOTHING and bench.loop.done == 1
    assert time.monotonic() - begin >= 1e-9 * SLICE_NS and not bench.loop.has_step
    assert bench.run(6) is Ended.NOTHING and bench.loop.done == 0


def test_a_message_by_socket_is_left_to_python(bench):
    """The loop ends once for each ring, whatever was posted since."""
    bench.post(encoded(5))
    assert bench.run(5) is Ended.ANSWERED
    ring_actuators(bench.board)
    begin = time.monotonic()
    assert bench.run(6) is Ended.NOTHING and not bench.loop.has_step
    assert time.monotonic() - begin < 1e-9 * SLICE_NS
    ring_actuators(bench.board)
    bench.post(encoded(6))
    assert bench.run(6) is Ended.ANSWERED and bench.answer == by_python(bench, 5, 6)
    assert bench.run(7) is Ended.NOTHING
    begin = time.monotonic()
    assert bench.run(7) is Ended.NOTHING
    assert time.monotonic() - begin >= 1e-9 * SLICE_NS


def by_python(bench: AtBoard, *ticks: int) -> bytes:
    return [bench.by_python(tick) for tick in ticks][-1]


@pytest.mark.parametrize('message', [
    encoded(8), encode_save(RUN, -1), encoded(7)[:-4], encoded(7) + bytes(4)],
    ids=['another tick', 'a save', 'shorter', 'longer'])
def test_what_is_unusual_is_left_as_it_came(bench, message):
    before = bench.actuator.snapshot()
    bench.post(message)
    assert bench.run(7) is Ended.OTHER and bench.loop.done == 0
    assert bench.loop.take_step() == message
    assert bench.actuator.snapshot() == before and bench.answer is None
    bench.post(encoded(7))
    assert bench.run(7) is Ended.ANSWERED and bench.answer == bench.by_python(7)


def test_a_step_larger_than_its_memory_is_cut(bench):
    """Only a defect posts one."""
    bench.post(encoded(7))
    bench.board.head['n_bytes'] = 2**30
    assert bench.run(7) is Ended.OTHER and len(bench.loop.take_step()) == LARGEST


def test_a_step_that_is_due_is_answered_at_the_board_later(bench):
    bench.post(encoded(7))
    assert bench.run(7, until_ns=0) is Ended.DUE and bench.loop.has_step
    assert bench.run(7) is Ended.ANSWERED and bench.answer == bench.by_python(7)


def test_whoever_sends_by_socket_rings(bench):
    bench.post(encoded(7))
    bench.loop.ring()
    assert bench.board.head['rings'][0] == LOUD - N


def test_one_without_a_slot_waits_at_the_socket(bench):
    """Of a board for other actuators; at any other it is seen waiting."""
    assert bench.board.slots['is_there'].tolist() == [0, 1, 0]
    bench.post(encoded(6))
    assert bench.run(6) is Ended.ANSWERED
    bench.loop.stand_at(bench.board, N)
    bench.coordinator.send(encoded(7))
    assert bench.run(7) is Ended.ANSWERED
    assert bench.coordinator.recv(LARGEST) == by_python(bench, 6, 7)
    bench.loop.stand_at(bench.board, 2)
    assert bench.board.slots['is_there'].tolist() == [0, 1, 1]
    bench.loop.stand_at(no_board(), 2)
    bench.coordinator.send(encoded(8))
    assert bench.run(8) is Ended.ANSWERED
    bench.loop.ring()


def test_at_another_board_the_first_step_is_new(bench):
    ring_actuators(bench.board)
    bench.post(encoded(5))
    assert bench.run(5) is Ended.ANSWERED and bench.run(6) is Ended.NOTHING
    other, file = new_board(N, LARGEST)
    bench.loop.stand_at(board_of(file, LARGEST), 0)
    os.close(file)
    post_on(other, encoded(6))
    assert bench.run(6) is Ended.ANSWERED
    assert answer_on(other, 0) == by_python(bench, 5, 6)
    ring_actuators(other)
    begin = time.monotonic()
    assert bench.run(7) is Ended.NOTHING
    assert time.monotonic() - begin < 1e-9 * SLICE_NS
