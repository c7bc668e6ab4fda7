"""Both sides of a board, as calls of Python."""

from typing import NamedTuple

from isa_ros.core.bound import Bound
from isa_ros.core.kernel import kernel
from isa_ros.core.system_calls import system_calls, SystemCalls
from isa_ros.run.wire.board import answer, are_there, bell_of, Board, post, ring, ring_all
from isa_ros.run.wire.words import words_of
import numpy as np


class Call(NamedTuple):
    """Memory of the calls below."""

    system: SystemCalls
    board: Board
    numbers: np.ndarray


@kernel
def call_post(own):
    post(own.system, own.board, own.numbers[0], own.numbers[1])
    return 0


@kernel
def call_answer(own):
    answer(own.system, own.board, own.numbers[0], own.numbers[1], own.numbers[2])
    return 0


@kernel
def call_are_there(own):
    return 1 if are_there(own.board) else 0


def _called(kernel_, board: Board, *numbers: int) -> int:
    return Bound(kernel_, Call(system_calls(), board, np.array([*numbers, 0], np.int64))).run()


def post_on(board: Board, message: bytes) -> None:
    """Post a step for all actuators."""
    words = words_of(message)
    _called(call_post, board, words.ctypes.data, words.nbytes)


def posted_on(board: Board) -> bytes:
    """Return the step that was posted last."""
    k = int(board.head['posted'][0]) % 2
    return board.steps[k].view(np.uint8)[:board.head['n_bytes'][0, k]].tobytes()


def put(board: Board, k: int, message: bytes) -> None:
    """Answer the step that was posted last."""
    words = words_of(message)
    board.answers[k, :len(words)] = words
    _called(call_answer, board, k, int(board.head['posted'][0]), words.nbytes)


def answer_on(board: Board, k: int) -> bytes | None:
    """Return the answer to the step that was posted last, None: it is not there."""
    if board.slots['answered'][k] != board.head['posted'][0]:
        return None
    return board.answers[k].view(np.uint8)[:board.slots['n_bytes'][k]].tobytes()


def all_there(board: Board) -> bool:
    return bool(_called(call_are_there, board))


def ring_coordinator(board: Board) -> None:
    bell_of(ring, board)()


def ring_actuators(board: Board) -> None:
    bell_of(ring_all, board)()
