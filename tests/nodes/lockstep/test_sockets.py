"""Both ends of the wire between processes of one host."""

from collections.abc import Iterator
import os
import secrets
import socket
import time

from isa_ros.nodes.lockstep import sockets as local_wire
from isa_ros.nodes.lockstep.sockets import LARGEST, LocalWire, LocalWires
from isa_ros.run.wire.board import are_possible, new_board
import pytest

RUN = secrets.randbits(63)  # another suite on this host must not meet this one
IDENTITIES = {0: b'identity of haa', 2: b'identity of kfe'}
SLICE_S = 0.05
LONG_SLICE_S = 10.0  # by far longer than a busy host keeps a process waiting

pytestmark = pytest.mark.skipif(
    not local_wire.is_possible(), reason="abstract socket names are Linux's")


@pytest.fixture
def wires() -> Iterator[LocalWires]:
    """Return a coordinator's end that accepts connections."""
    wires = LocalWires()
    wires.listen(RUN)
    yield wires
    wires.close()


def call(identity: bytes, run: int = RUN, slice_s: float = SLICE_S) -> LocalWire:
    wire = LocalWire.to_run(run, identity, slice_s)
    assert wire is not None
    return wire


@pytest.fixture
def ends(wires) -> Iterator[list[LocalWire]]:
    """Return the connected ends of two participants."""
    ends = [call(identity) for identity in IDENTITIES.values()]
    assert wires.connect(IDENTITIES)
    yield ends
    for end in ends:
        end.close()


@pytest.fixture
def patient_ends(wires) -> Iterator[list[LocalWire]]:
    """Return the connected ends of two participants that would wait for long."""
    ends = [call(identity, slice_s=LONG_SLICE_S) for identity in IDENTITIES.values()]
    assert wires.connect(IDENTITIES)
    yield ends
    for end in ends:
        end.close()


def received(wires: LocalWires, n: int) -> list[bytes | None]:
    return sorted((wires.wait(SLICE_S) for _ in range(n)), key=lambda data: data or b'')


def test_runs_at_the_same_time_have_sockets_of_their_own(wires):
    """The name holds the run's id: a participant reaches the coordinator that called it."""
    other = LocalWires()
    other.listen(RUN ^ 1)
    try:
        here, there = call(b'here'), call(b'there', RUN ^ 1)
        assert wires.connect({0: b'here'}) and other.connect({0: b'there'})
        assert wires.send(b'step of one') and other.send(b'step of the other')
        assert (here.wait(), there.wait()) == (b'step of one', b'step of the other')
        here.close()
        there.close()
    finally:
        other.close()


def test_a_run_that_does_not_listen_has_no_socket(wires):
    """Although another one of this host does."""
    assert LocalWire.to_run(RUN ^ 1, b'stray', SLICE_S) is None


def test_a_message_goes_to_all_and_each_answers_for_itself(wires, ends):
    for step in b'one', b'x' * LARGEST:
        assert wires.send(step)
        assert [end.wait() for end in ends] == [step, step]
        assert [end.send(b'%d ' % k + step[:9]) for k, end in enumerate(ends)] == [True, True]
        assert received(wires, 2) == [b'0 ' + step[:9], b'1 ' + step[:9]]
    assert wires.wait(0.0) is None


def test_silence_lasts_a_slice(wires, ends):
    for wait in (ends[0].wait, lambda: wires.wait(SLICE_S)):
        begin = time.monotonic()
        assert wait() is None
        assert time.monotonic() - begin >= 0.9 * SLICE_S
    assert ends[0].is_open


def test_too_large_an_answer_is_left_to_the_topics(wires, ends):
    assert not ends[0].send(b'x' * (LARGEST + 1))
    assert ends[0].send(b'next') and wires.wait(SLICE_S) == b'next'


def test_too_large_a_step_is_left_to_the_topics_and_so_is_the_rest(wires, ends):
    """Otherwise the participants would wait at both."""
    assert not wires.send(b'x' * (LARGEST + 1))
    assert not wires.is_open
    assert [end.wait() for end in ends] == [None, None]
    assert [end.is_open for end in ends] == [False, False]


def test_one_that_does_not_read_delays_no_other(wires, ends):
    """When its queue is full, the ticks go over the topics."""
    n = 0
    while wires.send(bytes(LARGEST)):
        assert ends[1].wait() == bytes(LARGEST)
        n += 1
    assert 0 < n < 1000 and not wires.is_open


def test_without_a_coordinator_on_this_host_there_is_no_wire():
    assert LocalWire.to_run(RUN + 1, b'me', SLICE_S) is None


def test_where_names_are_not_abstract_there_is_no_wire(monkeypatch):
    monkeypatch.setattr(local_wire, 'is_possible', lambda: False)
    wires = LocalWires()
    wires.listen(RUN)
    assert LocalWire.to_run(RUN, IDENTITIES[0], SLICE_S) is None
    assert not wires.connect(IDENTITIES)
    assert not wires.send(b'step')
    wires.close()


def test_with_one_elsewhere_all_hang_up(wires):
    here = call(IDENTITIES[0])
    assert not wires.connect(IDENTITIES)
    assert here.wait() is None and not here.is_open


def test_a_stranger_is_not_let_in(wires):
    strangers = [call(b'nobody'), call(b'i' * 1000), call(IDENTITIES[0][:-1])]
    ends = [call(identity) for identity in IDENTITIES.values()]
    assert wires.connect(IDENTITIES)
    for stranger in strangers:
        assert stranger.wait() is None and not stranger.is_open
    assert wires.send(b'step') and [end.wait() for end in ends] == [b'step', b'step']


def test_a_stranger_of_another_user_is_not_let_in(wires, monkeypatch):
    ends = [call(identity) for identity in IDENTITIES.values()]
    own = os.geteuid()
    monkeypatch.setattr(os, 'geteuid', lambda: own + 1)
    assert not wires.connect(IDENTITIES)
    assert [end.wait() for end in ends] == [None, None]


def test_repeated_foreign_connections_cause_no_delay(wires, monkeypatch):
    monkeypatch.setattr(local_wire, '_MOST_REJECTED', 3)
    strangers = [call(b'nobody') for _ in range(10)]
    ends = [call(identity) for identity in IDENTITIES.values()]
    assert not wires.connect(IDENTITIES)
    for end in strangers + ends:
        assert end.wait() is None and not end.is_open


def test_a_full_queue_of_connections_causes_no_delay(monkeypatch):
    monkeypatch.setattr(socket, 'SOMAXCONN', 1)
    wires = LocalWires()
    wires.listen(RUN)
    calls = [LocalWire.to_run(RUN, b'nobody', SLICE_S) for _ in range(4)]
    assert calls[0] is not None and calls[-1] is None
    wires.close()


def test_a_name_that_is_taken_is_left(wires):
    other = LocalWires()
    other.listen(RUN)
    assert not other.connect(IDENTITIES)
    ends = [call(identity) for identity in IDENTITIES.values()]
    assert wires.connect(IDENTITIES) and all(end.is_open for end in ends)


def test_the_default_timeout_of_the_process_does_not_matter(wires):
    """A user's controller may have set one."""
    socket.setdefaulttimeout(0.001)
    try:
        ends = [call(identity) for identity in IDENTITIES.values()]
        assert wires.connect(IDENTITIES)
    finally:
        socket.setdefaulttimeout(None)
    begin = time.monotonic()
    assert ends[0].wait() is None and ends[0].is_open
    assert time.monotonic() - begin >= 0.9 * SLICE_S
    assert wires.send(b'step') and ends[0].wait() == b'step'


def test_no_connection_is_accepted_once_the_run_goes_on(wires, ends):
    assert LocalWire.to_run(RUN, b'late', SLICE_S) is None


def test_where_one_closes_all_are_closed(wires, patient_ends):
    """Messages sent before the end are still read."""
    assert patient_ends[0].send(b'last')
    patient_ends[0].close()
    assert wires.wait(LONG_SLICE_S) == b'last' and wires.is_open
    begin = time.monotonic()
    assert wires.wait(LONG_SLICE_S) is None and not wires.is_open
    assert patient_ends[1].wait() is None and not patient_ends[1].is_open
    assert time.monotonic() - begin < LONG_SLICE_S
    assert not wires.send(b'step')


def test_a_coordinator_that_ends_is_noticed_at_once(wires, patient_ends):
    wires.close()
    begin = time.monotonic()
    assert patient_ends[0].wait() is None and not patient_ends[0].is_open
    assert not patient_ends[1].send(b'answer') and not patient_ends[1].is_open
    assert time.monotonic() - begin < LONG_SLICE_S


def test_a_coordinator_leads_one_run_after_the_other(wires, ends):
    wires.close()
    wires.listen(RUN + 1)
    with_others = {1: b'another'}
    end = call(b'another', RUN + 1)
    assert wires.connect(with_others)
    assert wires.send(b'step') and end.wait() == b'step'
    end.close()


@pytest.mark.skipif(not are_possible(), reason='a board needs Linux and machine code')
def test_the_first_message_brings_the_board_of_the_run(wires, ends):
    ours, file = new_board(2, LARGEST)
    wires.welcome(file)
    os.close(file)
    for end in ends:
        end.welcomed()
        assert end.is_open and len(end.board.slots) == 2
    ends[1].board.head['bell'] = 5
    assert ours.head['bell'] == ends[0].board.head['bell'] == 5
    assert wires.send(b'step') and [end.wait() for end in ends] == [b'step', b'step']


@pytest.mark.skipif(not hasattr(os, 'memfd_create'), reason='such files are those of Linux')
@pytest.mark.parametrize('is_file', [False, True])
def test_without_a_board_ticks_go_by_socket(wires, ends, is_file):
    """A run has none, or a file that is none."""
    file = os.memfd_create('other') if is_file else None
    n_files = len(os.listdir('/proc/self/fd'))
    wires.welcome(file)
    for end in ends:
        end.welcomed()
        assert end.board.at['bell'] == 0 and end.is_open != is_file
    assert len(os.listdir('/proc/self/fd')) == n_files - 2 * is_file
    if file is not None:
        os.close(file)


def test_one_that_is_not_welcomed_hangs_up(wires, ends):
    assert wires.send(b'another')
    for end in ends:
        end.welcomed()
        assert not end.is_open


def test_both_ends_ring_after_a_message_and_at_their_end(wires, ends):
    rung = []
    wires.ring, ends[0].ring = lambda: rung.append('ours'), lambda: rung.append('theirs')
    assert wires.send(b'step') and ends[0].send(b'answer')
    assert rung == ['ours', 'theirs']
    assert not ends[0].send(b'x' * (LARGEST + 1)) and rung == ['ours', 'theirs']
    ends[0].close()
    wires.close()
    assert rung == ['ours', 'theirs', 'theirs', 'ours']
