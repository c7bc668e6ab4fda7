"""Lost messages, and changes between sockets and topics."""

from collections.abc import Callable
import socket

from isa_ros.core.kernel import IS_COMPILED
from isa_ros.nodes.lockstep import coordinator_end as lockstep, sockets as local_wire
from isa_ros.nodes.lockstep.coordinator_end import LockstepTransport
from isa_ros.nodes.lockstep.participant_end import ParticipantEnd
from isa_ros.run.wire.coordinating import TickRound
import pytest
from tests.ros.lockstep.participants import (
    begin, DEADLINE_S, is_by_socket, make_transport, Scripted, spinning, tick)

pytestmark = pytest.mark.ros


@pytest.fixture(autouse=True)
def repeated_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the coordinator repeat what is lost after a fifth of a second, not of 1 s."""
    monkeypatch.setattr(lockstep, 'REPEAT_S', 0.2)


def dropping(send: Callable[[bytes], object]) -> Callable[[bytes], bool]:
    """Lose the first message, as if the middleware had dropped the participant for a while."""
    messages: list[bytes] = []

    def send_but_the_first(message: bytes) -> bool:
        if messages:
            send(message)
        messages.append(message)
        return True
    return send_but_the_first


def drop_next(end: LockstepTransport | ParticipantEnd, carrier: str) -> None:
    """Lose the next message that this end sends."""
    wire = end._wires if isinstance(end, LockstepTransport) else end._wire
    assert is_by_socket(end) == (carrier == 'sockets')
    if isinstance(end, LockstepTransport):
        end._rounds._are_possible = False   # which send by themselves
    if carrier == 'sockets':
        wire.send = dropping(wire.send)
    else:
        end._send = dropping(end._send)


def test_a_lost_step_is_asked_for_again(observer, carrier):
    stepper = Scripted()
    with spinning(observer.context, {'haa': Scripted(), 'kfe': stepper}):
        transport = make_transport(observer)
        begin(transport)
        drop_next(transport, carrier)
        assert tick(transport, 0) == [1.0, 2.0]
        assert tick(transport, 1) == [2.0, 3.0]
    assert stepper.ticks == 2


@pytest.mark.skipif(not IS_COMPILED, reason='rounds are machine code')
def test_a_step_that_a_round_loses_is_asked_for_again(observer, monkeypatch, carrier):
    """It is then the step of that round that the topic carries."""
    nowhere, _ = ends = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    send, lost = TickRound.send, []

    def send_but_the_third(self: TickRound, number: int) -> bool:
        if number != 2 or lost:
            return send(self, number)
        lost.append(number)
        sockets, self._own.sockets[:] = self._own.sockets.copy(), nowhere.fileno()
        is_sent = send(self, number)
        self._own.sockets[:] = sockets
        return is_sent
    monkeypatch.setattr(TickRound, 'send', send_but_the_third)
    steppers = {'haa': Scripted(), 'kfe': Scripted()}
    with spinning(observer.context, steppers):
        transport = make_transport(observer)
        rows = begin(transport)
        for number in range(20):
            assert tick(transport, number, rows) == [1.0 + number, 2.0 + number]
        assert lost == ([2] if carrier == 'sockets' else [])
    assert steppers['haa'].ticks == steppers['kfe'].ticks == 20
    for end in ends:
        end.close()


def test_a_lost_answer_is_given_again_without_another_tick(observer, ends, carrier):
    """The other participant repeats its answer too, which does not count as a second node."""
    steppers = {'haa': Scripted(), 'kfe': Scripted()}
    with spinning(observer.context, steppers):
        transport = make_transport(observer)
        begin(transport)
        drop_next(ends[1], carrier)
        for number in range(50):
            assert tick(transport, number) == [1.0 + number, 2.0 + number]
    assert steppers['haa'].ticks == steppers['kfe'].ticks == 50


@pytest.mark.parametrize('is_answer', [False, True], ids=['change', 'answer'])
def test_a_lost_change_of_parameters_is_made_once(observer, ends, carrier, is_answer):
    """Each actuator has its own values at the tick that follows, and at no other."""
    steppers = {'haa': Scripted(), 'kfe': Scripted()}
    with spinning(observer.context, steppers):
        transport = make_transport(observer)
        rows = begin(transport)
        tick(transport, 0, rows)
        drop_next(ends[1] if is_answer else transport, carrier)
        rows.changes = {1: {'plant.spool.stuck': 1.0}}
        assert tick(transport, 1, rows) == [2.0, 3.0]
        rows.changes = {}
        assert tick(transport, 2, rows) == [3.0, 4.0]
    assert (steppers['haa'].changes, steppers['kfe'].changes) == (
        [], [{'plant.spool.stuck': 1.0}])
    assert steppers['kfe'].ticks == 3


def test_a_lost_state_is_given_again(observer, ends, carrier):
    """A state is saved once for repeated requests; a later request saves a new one."""
    steppers = {'haa': Scripted(), 'kfe': Scripted()}
    with spinning(observer.context, steppers):
        transport = make_transport(observer)
        begin(transport)
        tick(transport, 0)
        drop_next(ends[0], carrier)
        assert transport.snapshots() == [b'after 1', b'after 1']
        steppers['haa'].ticks = 5
        assert transport.snapshots() == [b'after 5', b'after 1']


def test_a_repeat_that_newer_steps_have_overtaken_is_past(observer, monkeypatch):
    """During a long step of one participant its steps are repeated to all over the topics."""
    monkeypatch.setattr(lockstep, 'REPEAT_S', 0.01)
    monkeypatch.setattr(lockstep, 'SLICE_S', 0.01)  # or no repeat is due within the pause
    slow = Scripted()
    steppers = {'haa': Scripted(), 'kfe': slow}
    with spinning(observer.context, steppers):
        transport = make_transport(observer)
        begin(transport)
        tick(transport, 0)
        slow.pause_s = 0.03
        for number in range(1, 20):
            assert tick(transport, number) == [1.0 + number, 2.0 + number]
            assert transport.snapshots() == [b'after %d' % (number + 1)] * 2
    assert steppers['haa'].ticks == slow.ticks == 20


@pytest.mark.parametrize('closed', [[0], [0, 1]])
def test_without_sockets_the_topics_carry_the_run_on(
        observer, monkeypatch, ends, carrier, closed):
    """No step has to be repeated."""
    monkeypatch.setattr(lockstep, 'REPEAT_S', DEADLINE_S)
    steppers = {'haa': Scripted(), 'kfe': Scripted()}
    with spinning(observer.context, steppers):
        transport = make_transport(observer)
        begin(transport)
        tick(transport, 0)
        assert is_by_socket(transport) == (carrier == 'sockets')
        for k in closed:
            if ends[k]._wire is not None:
                ends[k]._wire.close()
        for number in range(1, 50):
            assert tick(transport, number) == [1.0 + number, 2.0 + number]
        assert not is_by_socket(transport)
        begin(transport)
        assert is_by_socket(transport) == (carrier == 'sockets')
    assert steppers['haa'].starts == 2


def test_steps_too_large_for_sockets_travel_as_topics(observer, monkeypatch, carrier):
    monkeypatch.setattr(local_wire, 'LARGEST', 200)
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted()}):
        transport = make_transport(observer)
        begin(transport)
        assert is_by_socket(transport) == (carrier == 'sockets')
        for number in range(50):
            assert tick(transport, number) == [1.0 + number, 2.0 + number]
        assert not is_by_socket(transport)


def test_a_participant_without_a_socket_keeps_all_on_topics(observer, monkeypatch):
    """The participant is on another host, or belongs to another user."""
    connect = local_wire.LocalWire.to_run
    taken: list[bytes] = []

    def one_only(run_id: int, identity: bytes, slice_s: float) -> local_wire.LocalWire | None:
        taken.append(identity)
        return connect(run_id, identity, slice_s) if len(taken) == 1 else None
    monkeypatch.setattr(local_wire.LocalWire, 'to_run', staticmethod(one_only))
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted()}):
        transport = make_transport(observer)
        begin(transport)
        assert not is_by_socket(transport)
        for number in range(50):
            assert tick(transport, number) == [1.0 + number, 2.0 + number]
    assert len(taken) == 2
