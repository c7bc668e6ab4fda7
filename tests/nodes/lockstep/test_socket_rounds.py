"""When the coordinator's ticks are compiled rounds over its sockets."""

from collections.abc import Iterator
import secrets

from isa_ros.core.kernel import IS_COMPILED
from isa_ros.core.signals import START
from isa_ros.nodes.lockstep import sockets
from isa_ros.nodes.lockstep.expected import Expected, Participants
from isa_ros.nodes.lockstep.socket_rounds import SocketRounds
from isa_ros.nodes.lockstep.sockets import LocalWire, LocalWires
from isa_ros.run.wire.roster import Roster
from isa_ros.run.wire.steps import encode_tick
import numpy as np
import pytest
from tests.run.test_wire import filled

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
