"""
The board of a run: memory that its processes on one host share, for steps and answers.

The coordinator posts a step once and wakes all actuators by one call; each puts its answer into
its slot, and the last one wakes the coordinator. By socket, each message is a call, a copy in the
system and a wake-up of its own. What an actuator waits for is the bell: whoever sends it a message
by socket rings too, and so does an actuator that sends one. A bell is the number of 4 bytes at
which the other side sleeps; a process that ends without a word is noticed when a wait ends.
"""

from collections.abc import Callable
import fcntl
import mmap
import os
from typing import NamedTuple

from isa_ros.core.bound import Bound
from isa_ros.core.kernel import IS_COMPILED, kernel
from isa_ros.core.pointers import add_at, load_at
from isa_ros.core.signals import COMMAND, SUPPLY_REPLY
from isa_ros.core.system_calls import can_wait, copy_memory, system_calls, SystemCalls, wake
from isa_ros.run.wire.answers import HEADER_BYTES
from isa_ros.run.wire.parts import ROWS_BYTES
from isa_ros.run.wire.words import WORD
import numpy as np

_LINE = 64      # bytes of a cache: what one side writes is not in the lines of the other
_MOST = 2**31 - 1
LOUD = 2**20
"""More than there are actuators: awakes the coordinator before all have answered."""

_BELL, _RINGS, _POSTED, _MESSAGES, _N_BYTES = 0, _LINE, 2 * _LINE, 2 * _LINE + 4, 2 * _LINE + 8
HEAD = np.dtype({
    'names': ['bell', 'rings', 'posted', 'messages', 'n_bytes'],
    'formats': ['<i4', '<i4', '<i4', '<i4', ('<i4', (2,))],
    'offsets': [_BELL, _RINGS, _POSTED, _MESSAGES, _N_BYTES], 'itemsize': 3 * _LINE})
"""
Of a board: both bells, and the counts of posted steps and of messages by socket.

Steps with even and odd numbers have places of their own, of ``n_bytes``: who still copies one is
not disturbed by the next, and the one after that waits for its answer. ``bell`` is that of the
actuators. ``rings``, that of the coordinator, is the number of answers that it waits for as one
below 0; from 0 on each ring wakes it.
"""
SLOT = np.dtype({
    'names': ['answered', 'n_bytes', 'is_there'], 'formats': ['<i4'] * 3, 'offsets': [0, 4, 8],
    'itemsize': _LINE})
"""Of an actuator: the step that it has answered, the bytes, and whether it waits at the board."""
_ANSWER = -(-(HEADER_BYTES + ROWS_BYTES + COMMAND.itemsize + SUPPLY_REPLY.itemsize + _LINE)
            // _LINE) * _LINE
_SEALS = getattr(fcntl, 'F_SEAL_SHRINK', 0) | getattr(fcntl, 'F_SEAL_GROW', 0)
# Who reads memory that is no longer there is ended by a signal.

AT = np.dtype([(name, 'i8') for name in ('bell', 'rings', 'posted', 'slots', 'steps')])


class Board(NamedTuple):
    """A board as kernels have it; messages are words of `isa_ros.run.wire.words`."""

    at: np.ndarray
    """Addresses, `AT`, (1,); 0: there is no board."""
    head: np.ndarray
    """`HEAD`, (1,)."""
    steps: np.ndarray
    """The last posted steps with an even and an odd number, (2, words)."""
    slots: np.ndarray
    """`SLOT` of each actuator, (n,)."""
    answers: np.ndarray
    """The last answer of each, (n, words)."""


class Ringing(NamedTuple):
    """Memory of `ring` and `ring_all`."""

    system: SystemCalls
    board: Board


@kernel
def are_there(board):
    """Return whether all actuators wait at the board."""
    if board.at[0].bell == 0:
        return False
    for k in range(len(board.slots)):
        if board.slots[k].is_there == 0:
            return False
    return True


@kernel
def post(system, board, address, size):
    """Post a step of so many bytes at an address for all actuators, and wake them."""
    at, head = board.at[0], board.head[0]
    k = (load_at(at.posted) + 1) & 1
    copy_memory(system, at.steps + k * WORD * board.steps.shape[1], address, size)
    head.n_bytes[k], head.rings = size, -len(board.slots)
    add_at(at.posted, 1)
    add_at(at.bell, 1)
    wake(system, at.bell, _MOST)


@kernel
def answer(system, board, k, posted, size):
    """Let the answer of actuator ``k`` to a posted step be there; the last one wakes."""
    at = board.at[0]
    answered = at.slots + k * _LINE
    board.slots[k].n_bytes = size
    add_at(answered, posted - load_at(answered))
    if add_at(at.rings, 1) >= 0:
        wake(system, at.rings, 1)


@kernel
def answered_by(board, k):
    """Return the last step that actuator ``k`` has answered, as its number."""
    return load_at(board.at[0].slots + k * _LINE)


@kernel
def ring(own):
    """Wake the coordinator: an actuator has sent it a message by socket. Return 0."""
    at = own.board.at[0]
    if at.bell != 0:
        add_at(at.rings, LOUD if load_at(at.rings) < 0 else 1)
        wake(own.system, at.rings, 1)
    return 0


@kernel
def ring_all(own):
    """Wake the actuators: the coordinator has sent them a message by socket. Return 0."""
    at = own.board.at[0]
    if at.bell != 0:
        own.board.head[0].messages += 1
        add_at(at.bell, 1)
        wake(own.system, at.bell, _MOST)
    return 0


def are_possible() -> bool:
    """Return whether processes of this host can have a board."""
    return IS_COMPILED and can_wait() and hasattr(os, 'memfd_create')


def bell_of(ringing: object, board: Board) -> Callable[[], int]:
    """Return a call of `ring` or `ring_all` of a board."""
    bound = Bound(ringing, Ringing(system_calls(), board))
    return lambda: bound.run()      # which alone does not hold the memory


def no_board() -> Board:
    """Return what kernels have without a board."""
    return Board(np.zeros(1, AT), np.zeros(1, HEAD), np.zeros((2, 1), np.uint32),
                 np.zeros(1, SLOT), np.zeros((1, _ANSWER // WORD), np.uint32))


def new_board(n_actuators: int, largest: int) -> tuple[Board, int]:
    """
    Return a board for steps of at most ``largest`` bytes, and its file, to be closed.

    Raises
    ------
    OSError
        There is no such memory, or no file for it.

    """
    file = os.memfd_create('isa_ros_board', os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    try:
        os.ftruncate(
            file, HEAD.itemsize + 2 * largest + n_actuators * (SLOT.itemsize + _ANSWER))
        fcntl.fcntl(file, fcntl.F_ADD_SEALS, _SEALS)
        return board_of(file, largest), file
    except OSError:
        os.close(file)
        raise


def board_of(file: int, largest: int) -> Board:
    """
    Return the board in a file of `new_board`.

    Raises
    ------
    OSError
        It is none.

    """
    if fcntl.fcntl(file, fcntl.F_GET_SEALS) & _SEALS != _SEALS:
        raise OSError('a board that could become smaller')
    first = HEAD.itemsize + 2 * largest
    n, rest = divmod(os.fstat(file).st_size - first, SLOT.itemsize + _ANSWER)
    if n < 1 or rest:
        raise OSError('a board of another size')
    memory = np.frombuffer(mmap.mmap(file, 0), np.uint8)
    head, posted, slots, answers = np.split(
        memory, [HEAD.itemsize, first, first + n * SLOT.itemsize])
    at = np.zeros(1, AT)
    at['bell'] = memory.ctypes.data
    at['rings'], at['posted'] = at['bell'] + _RINGS, at['bell'] + _POSTED
    at['slots'], at['steps'] = slots.ctypes.data, posted.ctypes.data
    return Board(at, head.view(HEAD), posted.view(np.uint32).reshape(2, -1), slots.view(SLOT),
                 answers.view(np.uint32).reshape(n, -1))
