"""The memory that processes of a run share, and its bells."""

from collections.abc import Iterator
import fcntl
import os

from isa_ros.run.wire import board as module
from isa_ros.run.wire.board import are_possible, Board, board_of, HEAD, LOUD, new_board, no_board
import pytest
from tests.run.boards import (
    all_there, answer_on, post_on, posted_on, put, ring_actuators, ring_coordinator)
from tests.run.sleeping import is_woken

pytestmark = pytest.mark.skipif(not are_possible(), reason='a board needs Linux and machine code')
N, LARGEST = 3, 4096


@pytest.fixture
def boards() -> Iterator[tuple[Board, Board]]:
    """Return both sides of one board: that of its coordinator and that of an actuator."""
    ours, file = new_board(N, LARGEST)
    theirs = board_of(file, LARGEST)
    os.close(file)
    yield ours, theirs


def rings(board: Board) -> int:
    return int(board.head['rings'][0])


def test_a_step_that_is_posted_is_there_for_all(boards):
    ours, theirs = boards
    assert theirs.steps[0].nbytes == LARGEST and len(theirs.slots) == N
    for count, message in enumerate((b'some step', b'another one.'), 1):
        message += bytes(-len(message) % 4)
        post_on(ours, message)
        assert posted_on(theirs) == message
        assert theirs.head['posted'] == theirs.head['bell'] == count
        assert rings(theirs) == -N and theirs.head['messages'] == 0


def test_a_step_stays_while_the_next_is_posted(boards):
    """Who has seen its number may still copy it."""
    ours, theirs = boards
    for message in (b'first...', b'second..', b'third...'):
        post_on(ours, message)
    assert [own.tobytes()[:8] for own in theirs.steps] == [b'second..', b'third...']
    assert theirs.head['n_bytes'].tolist() == [[8, 8]]


def test_without_its_memory_no_file_is_left(monkeypatch):
    files = []

    def sealed(file, *_):
        files.append(file)
        raise PermissionError('no seals')
    monkeypatch.setattr(module.fcntl, 'fcntl', sealed)
    with pytest.raises(PermissionError):
        new_board(N, LARGEST)
    with pytest.raises(OSError, match='Bad file descriptor'):
        os.fstat(files[0])


def test_answers_are_counted_and_are_of_the_last_step(boards):
    ours, theirs = boards
    post_on(ours, b'step')
    for k, message in (2, b'of kfe..'), (0, b'of haa......'), (1, b'of hfe..'):
        assert answer_on(ours, k) is None
        put(theirs, k, message)
        assert answer_on(ours, k) == message
    assert rings(ours) == 0
    post_on(ours, b'next')
    assert [answer_on(ours, k) for k in range(N)] == [None] * N and rings(ours) == -N


def test_all_are_there_once_each_is(boards):
    ours, theirs = boards
    for k in range(N):
        assert not all_there(ours)
        theirs.slots['is_there'][k] = 1
    assert all_there(ours) and not all_there(no_board())


def test_a_ring_is_heard_before_all_answers_are_there(boards):
    ours, theirs = boards
    post_on(ours, b'step')
    ring_coordinator(theirs)
    assert rings(ours) == LOUD - N >= 0
    ring_coordinator(theirs)
    assert rings(ours) == LOUD - N + 1
    ring_actuators(ours)
    assert theirs.head['messages'] == 1 and theirs.head['bell'] == 2
    for nothing in ring_coordinator, ring_actuators:
        nothing(no_board())


@pytest.mark.parametrize(('bell', 'wake'), [
    ('bell', lambda ours, theirs: ring_actuators(ours)),
    ('bell', lambda ours, theirs: post_on(ours, b'next')),
    ('rings', lambda ours, theirs: ring_coordinator(theirs))])
def test_a_bell_wakes_the_other_side(boards, bell, wake):
    ours, theirs = boards
    post_on(ours, b'step')
    sleeper = theirs if bell == 'bell' else ours
    assert is_woken(int(sleeper.at[bell][0]), int(sleeper.head[bell][0]),
                    lambda: wake(ours, theirs))


def test_the_last_answer_wakes(boards):
    ours, theirs = boards
    post_on(ours, b'step')
    for k in range(N - 1):
        put(theirs, k, b'done')
    assert is_woken(int(ours.at['rings'][0]), -1, lambda: put(theirs, N - 1, b'done'))
    assert rings(ours) == 0


@pytest.mark.parametrize('size', [
    HEAD.itemsize + LARGEST, HEAD.itemsize + LARGEST + 100, HEAD.itemsize + LARGEST + 9000, 1])
def test_a_file_of_another_size_is_no_board(size):
    file = os.memfd_create('board', os.MFD_ALLOW_SEALING)
    os.ftruncate(file, size)
    fcntl.fcntl(file, fcntl.F_ADD_SEALS, module._SEALS)
    with pytest.raises(OSError, match='another size'):
        board_of(file, LARGEST)
    os.close(file)


def test_a_file_that_could_become_smaller_is_no_board(boards):
    """Reading beyond its end would end the process."""
    file = os.memfd_create('board', os.MFD_ALLOW_SEALING)
    with pytest.raises(OSError, match='smaller'):
        board_of(file, LARGEST)
    os.close(file)
    _, file = new_board(N, LARGEST)
    with pytest.raises(PermissionError):
        os.ftruncate(file, 10)
    os.close(file)


def test_without_the_call_there_is_no_board(monkeypatch):
    monkeypatch.setattr(module, 'can_wait', lambda: False)
    assert not are_possible()
