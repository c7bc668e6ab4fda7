"""The coordinator's exchange with actuators that wait at the board of the run."""

from collections.abc import Callable, Iterator
import os
import threading
import time

from isa_ros.core.system_calls import SLICE_NS
from isa_ros.nodes.lockstep.sockets import LARGEST
from isa_ros.run.wire.answers import AnswerKind, encode_answer
from isa_ros.run.wire.board import are_possible, board_of, LOUD, new_board
from isa_ros.run.wire.parts import take_actuator_parts
from isa_ros.run.wire.steps import encode_tick
import pytest
from tests.run.boards import posted_on, put, ring_coordinator
from tests.run.test_coordinating import (
    answered, Bench, bytes_of, closed, encoded, made, N, RUN, spoilt, TICK)

pytestmark = pytest.mark.skipif(not are_possible(), reason='a board needs Linux and machine code')


class AtBoard(Bench):
    """The bench with a board at which actuators wait, after a step by socket."""

    def __init__(self, has_feed: bool = False) -> None:
        self.board, file = new_board(N, LARGEST)
        self.theirs = board_of(file, LARGEST)
        os.close(file)
        super().__init__(has_feed, self.board)
        for end in self.ends:
            end.recv(LARGEST)
            end.settimeout(0.0)
        self.theirs.slots['is_there'] = 1

    def answer(self, k: int, data: bytes) -> None:
        put(self.theirs, k, data)

    def posted(self) -> bytes:
        return posted_on(self.theirs)


@pytest.fixture
def bench() -> Iterator[AtBoard]:
    made = AtBoard()
    assert made.round.send(TICK)
    yield made
    closed(made)


def spent_s(work: Callable[[], object]) -> float:
    begin = time.monotonic()
    work()
    return time.monotonic() - begin


def test_a_step_goes_to_the_board_once_all_are_there():
    """Before, all get it by socket and are told so; controllers get it by socket always."""
    bench = AtBoard()
    bench.theirs.slots['is_there'][1] = 0
    assert bench.theirs.head['messages'] == 1 and not bench.round.is_awaiting
    assert bench.round.send(TICK + 1)
    assert [len(end.recv(LARGEST)) for end in bench.ends] == [len(bench.round.step())] * (N + 1)
    assert bench.theirs.head['messages'] == 2 and bench.theirs.head['posted'] == 0
    bench.theirs.slots['is_there'][1] = 1
    bench.rows.ports['x0'] += 0.25
    assert bench.round.send(TICK + 2) and bench.round.is_awaiting
    expected = encode_tick(RUN, TICK + 2, bench.rows, True)
    assert bench.posted() == bench.ends[N].recv(LARGEST) == expected == bench.round.step()
    for end in bench.ends:
        with pytest.raises(BlockingIOError):
            end.recv(1)
    assert bench.theirs.head['messages'] == 2 and bench.theirs.head['rings'] == -N
    closed(bench)


@pytest.mark.parametrize('has_feed', [False, True])
@pytest.mark.parametrize('are_sent', [(False,) * N, (True, False, True)])
def test_answers_are_taken_as_by_python(has_feed, are_sent):
    bench = AtBoard(has_feed)
    by_python = made(has_feed)
    for count in range(1, 3):
        assert bench.round.send(TICK)
        for k in (1, 2, 0):
            assert bench.round.is_awaiting
            bench.answer(k, encoded(k, has_feed, are_sent[k]))
            take_actuator_parts(answered(k, has_feed, are_sent[k]), k, by_python)
        before = bytes_of(bench.rows)
        assert bench.round.receive() and bytes_of(bench.rows) == before
        assert not bench.round.is_awaiting
        bench.round.take()
        assert bytes_of(bench.rows) == bytes_of(by_python)
        bench.rows.replies['force'] += 1.0
    closed(bench)


def test_it_sleeps_until_the_last_answer(bench):
    """Others before it wake it for nothing or not at all."""
    found = []
    thread = threading.Thread(target=lambda: found.append(bench.round.receive()))
    thread.start()
    for k in range(N):
        thread.join(0.02)
        bench.answer(k, encoded(k))
    thread.join()
    assert found == [True]


@pytest.mark.parametrize('name', [
    'word 3', 'word 14', 'given again', 'reply', 'applied', 'longer'])
@pytest.mark.parametrize('k', range(N))
def test_what_is_unusual_is_left_as_it_came(bench, name, k):
    """With all other answers; no row is filled."""
    before = bytes_of(bench.rows)
    expected = [encoded(own) if own != k else spoilt(name) for own in range(N)]
    for own, data in enumerate(expected):
        bench.answer(own, data)
    assert not bench.round.receive()
    assert bench.round.received() == expected and bytes_of(bench.rows) == before
    assert not bench.round.is_awaiting


def test_an_answer_is_cut_at_the_end_of_its_slot(bench):
    """Only a defect has a longer one."""
    for k in range(N):
        bench.answer(k, encoded(k))
    bench.theirs.slots['n_bytes'][1] = 2**30
    assert not bench.round.receive()
    assert len(bench.round.received()[1]) == bench.board.answers[1].nbytes


def test_silence_is_left_to_python_which_waits_on(bench):
    bench.answer(2, encoded(2))
    assert spent_s(lambda: bench.round.receive()) >= 1e-9 * SLICE_NS
    assert bench.round.received() == [] and bench.round.is_awaiting
    bench.round.listen()
    assert bench.round.late() == [encoded(2)] and bench.round.is_awaiting
    assert spent_s(lambda: bench.round.late()) >= 1e-9 * SLICE_NS
    bench.answer(0, encoded(0))
    assert bench.round.late() == [encoded(0)]
    threading.Timer(0.02, lambda: bench.answer(1, encoded(1))).start()
    while not (found := bench.round.late()):
        pass
    assert found == [encoded(1)] and not bench.round.is_awaiting
    assert bench.board.head['rings'][0] == LOUD


def test_a_ring_since_it_listened_is_heard(bench):
    """A message by socket that came while Python looked there."""
    for _ in range(2):
        bench.round.listen()
        ring_coordinator(bench.theirs)
        assert spent_s(lambda: bench.round.late()) < 1e-9 * SLICE_NS
    bench.round.listen()
    assert spent_s(lambda: bench.round.late()) >= 1e-9 * SLICE_NS


def test_a_message_by_socket_is_left_to_python_at_once(bench):
    """With the answers that are there."""
    bench.answer(1, encoded(1))
    ring_coordinator(bench.theirs)
    assert spent_s(lambda: bench.round.receive()) < 1e-9 * SLICE_NS
    assert bench.round.received() == [encoded(1)] and bench.round.is_awaiting


def test_an_answer_to_the_step_before_is_not_one_to_this(bench):
    """A straggler's: the answers that count have the number of their step."""
    for k in range(N):
        bench.answer(k, encoded(k))
    assert bench.round.receive()
    assert bench.round.send(TICK + 1)
    bench.board.head['rings'] = 0
    assert not bench.round.receive() and bench.round.received() == []


def test_answers_by_socket_do_not_count_at_the_board(bench):
    bench.ends[0].send(encode_answer(AnswerKind.DONE, RUN, TICK, 0, answered(0)))
    for k in 1, 2:
        bench.answer(k, encoded(k))
    ring_coordinator(bench.theirs)
    assert not bench.round.receive()
    assert bench.round.received() == [encoded(1), encoded(2)]
    assert bench.ours[0].recv(LARGEST) == encoded(0)


def test_answers_by_socket_are_awaited_no_longer():
    """A controller's answer would be found when a wait for the board ends."""
    bench = AtBoard(False)
    assert bench.round.send(TICK)
    bench.round.note(0)
    bench.answer(1, encoded(1))
    assert bench.round.is_awaiting and bench.round.late() == [encoded(1)]
    assert bench.round.is_awaiting
    bench.round.note(2)
    assert not bench.round.is_awaiting
    bench.round.take()
    assert bench.round.send(TICK + 1) and bench.round.is_awaiting
