"""The coordinator's compiled exchange sends and takes what Python does, and leaves the rest."""

from collections.abc import Iterator
from itertools import product
import socket
import struct
import time

from isa_ros.core.kernel import IS_COMPILED
from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_SETPOINT, WAS_REFUSED
from isa_ros.nodes.lockstep.sockets import LARGEST
from isa_ros.run.wire.answers import AnswerKind, encode_answer
from isa_ros.run.wire.board import Board, no_board
from isa_ros.run.wire.coordinating import TickRound
from isa_ros.run.wire.parts import actuator_parts, take_actuator_parts
from isa_ros.run.wire.steps import encode_tick
from isa_ros.tick.exchange import Rows
import numpy as np
import pytest
from tests.run.filled import filled, LEG

RUN, TICK, N = 0x1234_5678_9ABC_DEF0, 2**33 + 5, 3
SLICE_US = 20_000

pytestmark = pytest.mark.skipif(not IS_COMPILED, reason='the exchange is machine code')


def finite(rows: Rows) -> Rows:
    """Return rows whose numbers are finite and all different."""
    for own in (rows.ports, rows.samples, rows.replies, rows.supplies, rows.feeds, rows.fed):
        values = own.view(np.float64)
        values[:] = 1.0 + np.arange(values.size) + values.size
    return rows


def made(has_feed: bool = False) -> Rows:
    rows = finite(filled(N, bodies=LEG))
    rows.has_supply_ports = has_feed
    rows.applied['kinds'] = rows.sent['kinds'] = 0
    return rows


class Bench:
    """The exchange of three actuators and a controller, and their ends."""

    def __init__(self, has_feed: bool = False, board: Board | None = None) -> None:
        pairs = [socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET) for _ in range(N + 1)]
        self.ours, self.ends = zip(*pairs)
        for own in self.ours:
            own.setsockopt(
                socket.SOL_SOCKET, socket.SO_RCVTIMEO, struct.pack('@ll', 0, SLICE_US))
        self.has_feed, self.rows = has_feed, made(has_feed)
        self.round = TickRound(
            self.rows, RUN, [own.fileno() for own in self.ours], True, LARGEST,
            no_board() if board is None else board)
        assert self.round.send(TICK)

    def answer(self, k: int, data: bytes) -> None:
        self.ends[k].send(data)


def answered(k: int, has_feed: bool = False, is_sent: bool = False, tick: int = TICK) -> list:
    """Return the parts of an answer, different for each actuator."""
    own = made()
    for rows in own.replies, own.samples, own.fed:
        rows.view(np.float64)[:] *= 0.5
    own.applied['kinds'], own.applied['mode'] = WAS_REFUSED | HAS_ENABLE, 1
    own.applied['is_enabled'], own.applied['due_step'] = 1, 10 + k
    own.sent['kinds'], own.sent['due_step'] = HAS_SETPOINT if is_sent else 0, 20 + k
    for name in 'position', 'velocity', 'effort', 'stiffness', 'damping':
        own.sent[name] = 3.0 + np.arange(N)
    row = slice(k, k + 1)
    return actuator_parts(own.replies[row], own.samples[row], own.applied[row], {},
                          own.sent[row], own.fed[row] if has_feed else None)


def encoded(k: int, *form: bool, tick: int = TICK, run: int = RUN) -> bytes:
    return encode_answer(AnswerKind.DONE, run, tick, k, answered(k, *form))


def bytes_of(rows: Rows) -> list[bytes]:
    return [own.tobytes() for own in (
        rows.replies, rows.samples, rows.applied, rows.sent, rows.fed)]


@pytest.fixture
def bench() -> Iterator[Bench]:
    made = Bench()
    yield made
    closed(made)


def closed(bench: Bench) -> None:
    for own in (*bench.ours, *bench.ends):
        own.close()


@pytest.mark.parametrize('has_feed', [False, True])
def test_a_step_is_byte_for_byte_that_of_python(has_feed):
    """To actuators and controllers, with what the rows are at that moment."""
    bench = Bench(has_feed)
    for end in bench.ends:
        assert end.recv(LARGEST) == encode_tick(RUN, TICK, bench.rows, True)
    bench.rows.ports['x0'] += 0.25
    bench.rows.bodies['leg'].view(np.uint8)[:] = 7
    assert bench.round.send(TICK + 1)
    expected = encode_tick(RUN, TICK + 1, bench.rows, True)
    assert [end.recv(LARGEST) for end in bench.ends] == [expected] * (N + 1)
    assert bench.round.step() == expected
    assert not bench.round.is_too_large
    for less in 0, 1:
        too_large = TickRound(bench.rows, RUN, [], True, len(expected) - less, no_board())
        assert too_large.is_too_large == less
    closed(bench)


@pytest.mark.parametrize('has_feed', [False, True])
@pytest.mark.parametrize('are_sent', product([False, True], repeat=N))
def test_answers_are_taken_as_by_python(has_feed, are_sent):
    bench = Bench(has_feed)
    by_python = made(has_feed)
    for rows in bench.rows, by_python:
        rows.sent['kinds'] = HAS_ENABLE
    for k in (1, 2, 0):
        bench.answer(k, encoded(k, has_feed, are_sent[k]))
        take_actuator_parts(answered(k, has_feed, are_sent[k]), k, by_python)
    before = bytes_of(bench.rows)
    assert bench.round.receive()
    assert bytes_of(bench.rows) == before
    bench.round.take()
    assert bytes_of(bench.rows) == bytes_of(by_python) != before
    closed(bench)


def test_one_round_follows_the_other(bench):
    for tick in range(TICK, TICK + 3):
        assert bench.round.send(tick)
        for k in range(N):
            bench.answer(k, encoded(k, tick=tick))
        assert bench.round.receive()


def spoilt(name: str) -> bytes:
    """Return the answer of actuator 1, altered."""
    rows = made()
    if name == 'tuned':
        parts = answered(1)
        parts[1] = b'{"force.kp": 9e-08}'
        return encode_answer(AnswerKind.DONE, RUN, TICK, 1, parts)
    if name == 'given again':
        return encode_answer(AnswerKind.DONE, RUN, TICK, 1, answered(1), is_repeated=True)
    if name == 'refused':
        return encode_answer(AnswerKind.REFUSED, RUN, TICK, 1, [b'no'])
    if name == 'of a run with ports':
        return encoded(1, True)
    data = bytearray(encoded(1, False, name.startswith('sent')))
    if name.startswith('word'):
        data[4 * int(name.split()[1])] ^= 1
    at = {'reply': 60, 'sample': 60 + rows.replies[:1].nbytes}
    at['applied'] = at['sample'] + rows.samples[:1].nbytes
    at['last sample'], at['sent'] = at['applied'] - 8, at['applied'] + COMMAND.itemsize
    if name in ('reply', 'sample', 'last sample'):
        data[at[name]:at[name] + 8] = struct.pack('<d', np.inf)
    elif name in ('applied', 'sent'):
        data[at[name]:at[name] + 4] = struct.pack('<I', 2**20)
    elif name == 'sent, and refused':
        data[at['sent']:at['sent'] + 4] = struct.pack('<I', WAS_REFUSED)
    elif name == 'longer':
        data += bytes(4)
    return bytes(data)


HEAD = [f'word {k}' for k in range(15)]


@pytest.mark.parametrize('name', [
    *HEAD, 'tuned', 'given again', 'refused', 'of a run with ports', 'reply', 'sample',
    'last sample', 'applied', 'sent', 'sent, and refused', 'longer'])
def test_what_is_unusual_is_left_as_it_came(bench, name):
    """With the other answers of the tick that have arrived before; no row is filled."""
    before = bytes_of(bench.rows)
    for k in 0, 2:
        bench.answer(k, encoded(k))
    bench.answer(1, spoilt(name))
    assert not bench.round.receive()
    assert bench.round.received() == [spoilt(name), encoded(2)]
    assert bytes_of(bench.rows) == before
    assert bench.ours[0].recv(LARGEST) == encoded(0)    # is still there


def test_a_supplys_reply_that_is_not_finite_is_left():
    bench = Bench(has_feed=True)
    for k in range(N):
        bench.answer(k, encoded(k, True)[:-8] + struct.pack('<d', np.nan if k == 0 else 1.0))
    assert not bench.round.receive()
    assert len(bench.round.received()) == N
    closed(bench)


def test_silence_and_an_end_are_left(bench):
    bench.answer(2, encoded(2))
    begin = time.monotonic()
    assert not bench.round.receive()
    assert time.monotonic() - begin >= 0.9e-6 * SLICE_US
    assert bench.round.received() == [encoded(2)]
    bench.ends[2].close()
    assert not bench.round.receive() and bench.round.received() == []


def test_one_that_does_not_read_delays_no_other(bench):
    tick = TICK
    while bench.round.send(tick):
        for k in (0, 2, 3):
            bench.ends[k].recv(LARGEST)
        tick += 1
    assert 0 < tick - TICK < 1000


def test_a_socket_that_is_closed_is_noticed(bench):
    bench.ends[3].close()
    assert not bench.round.send(TICK + 1)
