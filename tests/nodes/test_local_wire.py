"""Both ends of the wire between processes of one host."""

from collections.abc import Iterator
import time

from isa_ros.nodes import local_wire
from isa_ros.nodes.local_wire import LARGEST, LocalWire, LocalWires
import pytest

RUN = 0x1234_5678_9abc
IDENTITIES = {0: b'identity of haa', 2: b'identity of kfe'}
SLICE_S = 0.05

pytestmark = pytest.mark.skipif(
    not local_wire.is_possible(), reason="abstract socket names are Linux's")


@pytest.fixture
def wires() -> Iterator[LocalWires]:
    """Return a coordinator's end that others can call."""
    wires = LocalWires()
    wires.listen(RUN)
    yield wires
    wires.close()


def call(identity: bytes, run: int = RUN) -> LocalWire:
    wire = LocalWire.to_run(run, identity, SLICE_S)
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


def received(wires: LocalWires, n: int) -> list[bytes | None]:
    return sorted((wires.wait(SLICE_S) for _ in range(n)), key=lambda data: data or b'')


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


def test_what_is_too_large_is_left_to_the_topics(wires, ends):
    assert not wires.send(b'x' * (LARGEST + 1))
    assert not ends[0].send(b'x' * (LARGEST + 1))
    assert wires.send(b'next') and ends[0].wait() == b'next'


def test_one_that_does_not_read_holds_nobody_up(wires, ends):
    """Its queue is full one day."""
    for number in range(1000):
        assert wires.send(b'%d' % number + bytes(LARGEST - 9))
        data = ends[1].wait()
        assert data is not None and data.startswith(b'%d' % number)


def test_without_a_coordinator_on_this_host_there_is_no_wire():
    assert LocalWire.to_run(RUN + 1, b'me', SLICE_S) is None


def test_where_names_are_not_abstract_there_is_no_wire(monkeypatch):
    monkeypatch.setattr(local_wire, 'is_possible', lambda: False)
    wires = LocalWires()
    wires.listen(RUN)
    assert LocalWire.to_run(RUN, IDENTITIES[0], SLICE_S) is None
    assert not wires.connect(IDENTITIES)
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


def test_nobody_can_call_once_the_run_goes_on(wires, ends):
    assert LocalWire.to_run(RUN, b'late', SLICE_S) is None


def test_one_that_ends_is_silent_and_the_others_go_on(wires, ends):
    assert ends[0].send(b'last')
    ends[0].close()
    assert ends[1].send(b'from the other')
    assert [data for data in received(wires, 4) if data] == [b'from the other', b'last']
    assert wires.send(b'step') and ends[1].wait() == b'step'


def test_a_coordinator_that_ends_is_noticed_at_once(wires, ends):
    wires.close()
    begin = time.monotonic()
    assert ends[0].wait() is None and not ends[0].is_open
    assert not ends[1].send(b'answer') and not ends[1].is_open
    assert time.monotonic() - begin < SLICE_S


def test_a_coordinator_leads_one_run_after_the_other(wires, ends):
    wires.close()
    wires.listen(RUN + 1)
    with_others = {1: b'another'}
    end = call(b'another', RUN + 1)
    assert wires.connect(with_others)
    assert wires.send(b'step') and end.wait() == b'step'
    end.close()
