"""When the coordinator's ticks are compiled rounds over its sockets."""

from collections.abc import Iterator
import secrets
import threading
import time

from isa_ros.core.kernel import IS_COMPILED
from isa_ros.core.signals import START
from isa_ros.core.system_calls import SLICE_NS
from isa_ros.nodes.lockstep import socket_rounds, sockets
from isa_ros.nodes.lockstep.expected import Expected, Participants
from isa_ros.nodes.lockstep.socket_rounds import RoundEnds, SocketRounds
from isa_ros.nodes.lockstep.sockets import LocalWire, LocalWires
from isa_ros.run.wire.board import are_possible, Board
from isa_ros.run.wire.roster import Roster
from isa_ros.run.wire.steps import encode_tick
import numpy as np
import pytest
from tests.run.boards import posted_on, put, ring_coordinator
from tests.run.filled import filled

RUN = secrets.randbits(63)
NAMES = ['haa', 'kfe', 'follower']

pytestmark = pytest.mark.skipif(
    not (IS_COMPILED and sockets.is_possible()), reason='rounds are machine code over sockets')


def participants(first_remote: int = 0, n_actuators: int = 2) -> Participants:
    return Participants([Expected(name, '') for name in NAMES], Roster(NAMES, [], {}),
                        np.zeros(n_actuators, START), 1_000_000, first_remote)


@pytest.fixture
def wires() -> Iterator[LocalWires]:
    made = LocalWires()
    made.listen(RUN)
    yield made
    made.close()


@pytest.fixture
def ends(wires) -> Iterator[list[LocalWire]]:
    identities = {k: name.encode() for k, name in enumerate(NAMES)}
    made = [LocalWire.to_run(RUN, identities[k], 0.05) for k in (2, 0, 1)]
    assert None not in made and wires.connect(identities)
    yield [made[1], made[2], made[0]]
    for end in made:
        end.close()


@pytest.fixture
def rows():
    return filled(2, bodies={})


def test_a_step_goes_to_all_in_the_order_of_the_participants(wires, ends, rows):
    rounds = SocketRounds(wires, participants())
    assert rounds.step() == b'' and rounds.receive() == []
    assert rounds.send(RUN, 3, rows)
    expected = encode_tick(RUN, 3, rows, True)
    assert [end.wait() for end in ends] == [expected] * 3 and rounds.step() == expected
    for end, answer in zip(ends, (b'of haa', b'of kfe', b'of the follower')):
        assert end.send(answer)
    assert rounds.receive() == [b'of kfe']      # the last actuator is asked first
    assert wires.wait(0.0) in (b'of haa', b'of the follower')


def test_where_one_socket_fails_all_close_and_none_gets_the_step_twice(wires, ends, rows):
    rounds = SocketRounds(wires, participants())
    ends[2].close()
    assert not rounds.send(RUN, 3, rows) and not wires.is_open
    assert ends[0].wait() == encode_tick(RUN, 3, rows, True)
    assert ends[0].wait() is None and not ends[0].is_open
    assert rounds.receive() == []
    assert not rounds.send(RUN, 3, rows)


def test_after_a_step_that_was_not_sent_nothing_is_received(wires, ends, rows, monkeypatch):
    rounds = SocketRounds(wires, participants())
    assert rounds.send(RUN, 3, rows)
    with monkeypatch.context() as patch:
        patch.setattr(sockets, 'LARGEST', 100)
        assert not rounds.send(RUN, 4, filled(2, bodies={})) and wires.is_open
    assert ends[1].send(b'late')
    assert rounds.receive() == []
    assert ends[0].wait() == encode_tick(RUN, 3, rows, True) and ends[0].wait() is None


@pytest.mark.parametrize('run', [participants(2), participants(0, 0)])
def test_without_an_actuator_elsewhere_there_are_no_rounds(wires, ends, rows, run):
    assert not SocketRounds(wires, run).send(RUN, 3, rows)
    assert wires.is_open and ends[0].wait() is None


def quiet_ends(wires, ends, rows) -> tuple[SocketRounds, RoundEnds, list[tuple[int, bool]]]:
    """Return rounds without controllers, whose first step is sent, and what ends of ticks said."""
    ended: list[tuple[int, bool]] = []

    def end(tick: int, is_unsent: bool) -> None:
        ended.append((tick, is_unsent))
    run = participants()
    rounds = SocketRounds(wires, run)
    rounds._has_controllers = False
    assert rounds.ends(RUN, end) is None    # before a step
    assert rounds.send(RUN, 3, rows)
    made = rounds.ends(RUN, end)
    assert made is rounds.ends(RUN, end) is not None and rounds.ends(RUN + 1, end) is None
    return rounds, made, ended


def test_messages_of_a_tick_that_is_not_answered_are_left_once(wires, ends, rows):
    rounds, made, ended = quiet_ends(wires, ends, rows)
    assert rounds.left() == []
    assert ends[1].send(b'of kfe')
    made.begin_quiet(7)
    assert [part.bound.run() for part in made.parts[:2]] == [0, 1]
    assert made.end_quiet(5, 2, 1)
    assert ended == [(7, False)]
    assert rounds.left() == [b'of kfe'] and rounds.left() == []
    assert ends[0].wait() == encode_tick(RUN, 3, rows, False)
    assert ends[0].wait() == encode_tick(RUN, 7, rows, False) == rounds.step()


@pytest.mark.parametrize(('n_ticks', 'place', 'expected', 'has_begun'), [
    (4, -1, [(13, False)], False), (4, -9, [(13, False)], False), (0, -1, [], False),
    (4, 0, [(14, True)], True), (0, 0, [(10, True)], True), (4, 1, [(14, False)], True),
    (4, 2, [(14, False)], False), (0, 5, [(10, False)], False)])
def test_the_last_tick_is_that_of_the_last_step(
        wires, ends, rows, n_ticks, place, expected, has_begun):
    """One that was finished by what follows the actuators has been answered."""
    _, made, ended = quiet_ends(wires, ends, rows)
    assert made.end_quiet(10, n_ticks, place) == has_begun
    assert ended == expected


def test_ticks_are_not_quiet_with_a_change_a_controller_or_a_closed_socket(wires, ends, rows):
    rounds, made, _ = quiet_ends(wires, ends, rows)
    assert made.is_settled
    rows.tuned = {0: {'force.kp': 1e-7}}
    assert not made.is_settled
    rounds._has_controllers = True
    assert rounds.ends(RUN, lambda tick, is_unsent: None) is None
    rounds._has_controllers = False
    wires.close()
    assert rounds.ends(RUN, lambda tick, is_unsent: None) is None


def test_another_run_has_other_ends(wires, ends, rows):
    rounds, made, _ = quiet_ends(wires, ends, rows)
    assert rounds.send(RUN + 5, 0, rows)
    other = rounds.ends(RUN + 5, lambda tick, is_unsent: None)
    assert other is not None and other is not made and other.parts != made.parts


def welcomed(rounds: SocketRounds, ends: list[LocalWire]) -> list[Board]:
    """Return the boards that the actuators have received; all of them are there."""
    rounds.begin()
    for k, end in enumerate(ends):
        end.welcomed()
        if k < 2 and end.board.at['bell'][0]:
            end.board.slots['is_there'][k] = 1
    return [end.board for end in ends]


@pytest.mark.skipif(not are_possible(), reason='a board needs Linux')
def test_actuators_get_their_steps_at_the_board(wires, ends, rows):
    """Python waits for what is late at the board and by socket, and looks at both."""
    rounds = SocketRounds(wires, participants())
    first, second, _ = welcomed(rounds, ends)
    assert rounds.send(RUN, 3, rows)
    expected = encode_tick(RUN, 3, rows, True)
    assert posted_on(first) == expected and ends[2].wait() == expected
    put(second, 1, b'of kfe..')
    assert ends[2].send(b'of the follower')
    assert rounds.receive() == []
    assert {rounds.wait(0.1), rounds.wait(0.1)} == {b'of kfe..', b'of the follower'}
    begin = time.monotonic()
    assert rounds.wait(0.1) is None
    assert time.monotonic() - begin >= 1e-9 * SLICE_NS
    put(first, 0, b'of haa..')
    assert rounds.wait(0.1) == b'of haa..'
    timer = threading.Timer(3e-9 * SLICE_NS, lambda: ends[2].send(b'later'))
    timer.start()       # all have answered: it waits at the sockets, where nobody rings
    assert rounds.wait(30.0) == b'later'
    timer.join()
    wires.close()
    assert first.head['messages'] == 1 and ends[0].wait() is None


@pytest.mark.skipif(not are_possible(), reason='a board needs Linux')
def test_several_late_answers_are_returned_one_by_one(wires, ends, rows):
    rounds = SocketRounds(wires, participants())
    boards = welcomed(rounds, ends)
    assert rounds.send(RUN, 3, rows)
    for k, message in enumerate((b'of haa..', b'of kfe..')):
        put(boards[k], k, message)
    assert {rounds.wait(0.0), rounds.wait(0.0)} == {b'of haa..', b'of kfe..'}
    assert rounds.wait(0.0) is None


@pytest.mark.skipif(not are_possible(), reason='a board needs Linux')
def test_an_answer_by_socket_is_not_kept_waiting_by_the_board(wires, ends, rows):
    """It has rung before Python looks, as all answers that Python gives."""
    rounds = SocketRounds(wires, participants())
    boards = welcomed(rounds, ends)
    assert rounds.send(RUN, 3, rows)
    begin = time.monotonic()
    for _ in range(20):
        assert ends[1].send(b'of kfe')
        ring_coordinator(boards[1])
        assert rounds.wait(10.0) == b'of kfe'
    assert time.monotonic() - begin < 20 * 1e-9 * SLICE_NS


@pytest.mark.parametrize('run', [participants(2), participants(0, 0)])
def test_without_rounds_there_is_no_board(wires, ends, rows, run):
    for board in welcomed(SocketRounds(wires, run), ends):
        assert board.at['bell'] == 0
    assert wires.send(b'step') and ends[0].wait() == b'step'


def test_without_memory_for_a_board_all_goes_by_socket(monkeypatch, wires, ends, rows):
    def refused(n_actuators, largest):
        raise PermissionError('memfd_create')
    monkeypatch.setattr(socket_rounds, 'new_board', refused)
    rounds = SocketRounds(wires, participants())
    assert not any(own.at['bell'][0] for own in welcomed(rounds, ends))
    assert rounds.send(RUN, 3, rows)
    assert [end.wait() for end in ends] == [encode_tick(RUN, 3, rows, True)] * 3


@pytest.mark.skipif(not are_possible(), reason='a board needs Linux')
def test_a_controller_is_heard_at_once_after_actuators_that_answer_by_socket(wires, ends, rows):
    """It rings no bell: a wait at the board would be one of 0.1 s in each tick."""
    rounds = SocketRounds(wires, participants())
    welcomed(rounds, ends)
    assert rounds.send(RUN, 3, rows)
    for k in (0, 1):
        assert ends[k].send(b'of an actuator')
        assert rounds.wait(0.1) == b'of an actuator'
        rounds.note(k)
    assert not rounds._round.is_awaiting
    rounds.note(2)      # a controller, which has no place at the board
    assert ends[2].send(b'of the follower') and rounds.wait(0.1) == b'of the follower'
