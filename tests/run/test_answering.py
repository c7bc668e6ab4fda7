"""The compiled loop of an actuator's end answers as Python does, and leaves the rest to it."""

from collections.abc import Iterator
import socket
import struct
import time

from isa_ros.config.runs.default_actuator import DEFAULT_TIMING
from isa_ros.core.kernel import IS_COMPILED
from isa_ros.core.signals import HAS_CLEAR_FAULT, HAS_SETPOINT, LOAD_PORT
from isa_ros.core.timebase import PLANT_STEP_NS
from isa_ros.errors import SimulationDiverged
from isa_ros.nodes.lockstep.sockets import LARGEST
from isa_ros.run.wire.answer_loop import _KEPT, MOST_KEPT
from isa_ros.run.wire.answering import Ended
from isa_ros.run.wire.steps import decode_step, encode_save, encode_tick
import numpy as np
import pytest
from tests.run.answer_bench import Bench, closed, encoded, INDEX, RUN, step_rows

SECOND = 1000           # ticks
FEED = 'with a feed'

pytestmark = pytest.mark.skipif(not IS_COMPILED, reason='the loop is machine code')


@pytest.fixture
def bench() -> Iterator[Bench]:
    one = Bench()
    yield one
    closed(one)


@pytest.mark.parametrize('has_feed', [False, True], ids=['', FEED])
@pytest.mark.parametrize('is_linked', [False, True], ids=['', 'behind a link'])
def test_an_answer_is_byte_for_byte_that_of_python(has_feed, is_linked):
    """With a command that takes effect, and others that are of other actuators."""
    bench = Bench(has_feed, is_linked)
    for tick in range(2**33, 2**33 + 40):   # beyond 32 bits
        target = 0.012 if tick % 10 == 3 else None
        bench.coordinator.send(encoded(tick, has_feed=has_feed, target=target))
        assert bench.run(tick) is Ended.ANSWERED and bench.loop.done == 1
        assert bench.coordinator.recv(LARGEST) == bench.by_python(tick, target)
    assert bench.actuator.memory.replies[0]['velocity'] != 0.0
    assert not has_feed or bench.actuator.memory.fed[0]['flow'] != 0.0
    closed(bench)


def test_several_ticks_are_one_call(bench):
    for tick in range(5, 9):
        bench.coordinator.send(encoded(tick))
    assert bench.run(5, most=3) is Ended.ANSWERED and bench.loop.done == 3
    assert [bench.coordinator.recv(LARGEST) for _ in range(3)] == [
        bench.by_python(tick) for tick in (5, 6, 7)]
    assert bench.run(8, most=3) is Ended.NOTHING and bench.loop.done == 1
    assert bench.coordinator.recv(LARGEST) == bench.by_python(8)


@pytest.mark.parametrize('tick, target', [(SECOND - 3, None), (20, 0.02)])
def test_the_loop_ends_where_something_is_published(bench, tick, target):
    """At a full second, and with a command that took effect."""
    for actuator in bench.actuator, bench.twin:
        actuator.end_ticks(tick - 2 - actuator.t_ns // DEFAULT_TIMING.step_ns, 0)
    bench.actuator.ticked.clock[0] = bench.actuator.t_ns // PLANT_STEP_NS
    for k in range(tick - 2, tick + 3):
        bench.coordinator.send(encoded(k, target=target if k == tick else None))
    news = tick if target is not None else SECOND - 1
    assert bench.run(tick - 2, most=9) is Ended.ANSWERED
    assert bench.loop.done == news - (tick - 2) + 1


def test_commands_are_kept_for_what_is_published_of_them(bench):
    """With the ends of their ticks, over several calls, until there is no more room."""
    targets = {8: 0.021, 9: 0.022, 11: 0.023}
    begin = bench.actuator.t_ns
    for k in range(7, 12):
        bench.coordinator.send(encoded(k, target=targets.get(k)))
    assert bench.run(7, most=5, keeps=True) is Ended.ANSWERED and bench.loop.done == 5
    bench.coordinator.send(encoded(12, target=0.024))
    assert bench.run(12, keeps=True) is Ended.ANSWERED and bench.loop.n_kept == 4
    assert [(t_ns - begin, command['position'], command['kinds'])
            for t_ns, command in bench.loop.take_kept()] == [
                (k * 1_000_000, target, HAS_SETPOINT)
                for k, target in ((2, 0.021), (3, 0.022), (5, 0.023), (6, 0.024))]
    assert bench.loop.take_kept() == []
    for k in range(13, 13 + MOST_KEPT + 1):
        bench.coordinator.send(encoded(k, target=0.02))
        bench.run(k, keeps=True)
        bench.coordinator.recv(LARGEST)
        if bench.loop.n_kept == MOST_KEPT:
            break
    assert k == 12 + MOST_KEPT and len(bench.loop.take_kept()) == MOST_KEPT


def test_the_loop_ends_at_a_status_with_a_command_that_is_kept(bench):
    """Both are of the tick that reaches a full second."""
    for actuator in bench.actuator, bench.twin:
        actuator.end_ticks(SECOND - 2 - actuator.t_ns // DEFAULT_TIMING.step_ns, 0)
    bench.actuator.ticked.clock[0] = bench.actuator.t_ns // PLANT_STEP_NS
    for k in range(SECOND - 2, SECOND + 2):
        bench.coordinator.send(encoded(k, target=0.02))
    assert bench.run(SECOND - 2, most=4, keeps=True) is Ended.ANSWERED
    assert bench.loop.done == 2 and bench.loop.n_kept == 2


def test_the_loop_ends_where_there_is_no_more_room_for_commands(bench):
    bench.loop._values[_KEPT] = MOST_KEPT - 2
    for k in range(7, 11):
        bench.coordinator.send(encoded(k, target=0.02))
    assert bench.run(7, most=4, keeps=True) is Ended.ANSWERED
    assert bench.loop.done == 2 and bench.loop.n_kept == MOST_KEPT


def test_a_command_handed_to_a_link_is_published():
    """Before a frame brings it to the REU."""
    bench = Bench(is_linked=True)
    for k in range(7, 12):
        bench.coordinator.send(encoded(k, target=0.02 if k == 9 else None))
    assert bench.run(7, most=9) is Ended.ANSWERED and bench.loop.done == 3
    assert bench.actuator.memory.sent['kinds'].tolist() == [HAS_SETPOINT]
    assert bench.actuator.memory.applied['kinds'].tolist() == [0]
    closed(bench)


def spoilt(name: str) -> bytes:
    """Return tick 7, altered."""
    rows = step_rows(7)
    if name == 'infinite port':
        rows.ports['damping'][INDEX] = np.inf
    elif name == 'kind':
        rows.commands['kinds'][INDEX] = 128
    elif name == 'gain':
        rows.commands[INDEX] = rows.commands[0]
        rows.commands['stiffness'][INDEX] = -1.0
    data = bytearray(encode_tick(RUN, 7, rows, False))
    if name == 'longer':
        data += bytes(4)
    elif name == 'shorter':
        del data[-4:]
    elif name == 'stub':
        del data[6:]
    elif name.isdecimal():
        data[int(name)] ^= 1
    return bytes(data)


@pytest.mark.parametrize('name', [
    *map(str, range(40)), 'infinite port', 'kind', 'gain', 'longer', 'shorter', 'stub'])
def test_what_is_unusual_is_left_as_it_came(bench, name):
    """Each byte of the header, of which the last eight are the tick."""
    before = bench.actuator.snapshot()
    bench.coordinator.send(spoilt(name))
    assert bench.run(7) is Ended.OTHER and bench.loop.done == 0
    assert bench.loop.has_step and bench.loop.take_step() == spoilt(name)
    assert not bench.loop.has_step
    assert bench.actuator.snapshot() == before
    bench.coordinator.send(encoded(7))
    assert bench.run(7) is Ended.ANSWERED
    assert bench.coordinator.recv(LARGEST) == bench.by_python(7)


@pytest.mark.parametrize('field', LOAD_PORT.names)
def test_each_number_of_a_port_is_checked(bench, field):
    rows = step_rows(7)
    rows.ports[field][INDEX] = np.nan
    bench.coordinator.send(encode_tick(RUN, 7, rows, False))
    assert bench.run(7) is Ended.OTHER and np.isfinite(bench.actuator.ticked.ports[field]).all()


def test_a_port_of_a_supply_that_is_not_finite_is_left():
    bench = Bench(has_feed=True)
    rows = step_rows(7, has_feed=True)
    rows.feeds['flow'][INDEX] = np.nan
    bench.coordinator.send(encode_tick(RUN, 7, rows, False))
    assert bench.run(7) is Ended.OTHER
    assert np.isfinite(bench.actuator.memory.feeds.view(np.float64)).all()
    closed(bench)


def test_numbers_of_other_actuators_are_theirs(bench):
    rows = step_rows(7)
    rows.ports['x0'][[0, 2]], rows.commands['kinds'][[0, 2]] = np.nan, 2**31
    bench.coordinator.send(encode_tick(RUN, 7, rows, False))
    assert bench.run(7) is Ended.ANSWERED
    assert bench.coordinator.recv(LARGEST) == bench.by_python(7)


def test_before_a_tick_was_checked_none_is_taken(bench):
    bench.loop.forget()
    assert not bench.loop.is_expecting
    bench.coordinator.send(encoded(7))
    assert bench.run(7) is Ended.OTHER and bench.loop.take_step() == encoded(7)
    bench.loop.expect(decode_step(encoded(7)), INDEX, False)
    bench.coordinator.send(encoded(7))
    assert bench.loop.is_expecting and bench.run(7) is Ended.ANSWERED


def test_steps_of_another_form_are_taken_once_they_were_checked(bench):
    """Of another run, and those with supplies' ports."""
    other = encode_tick(RUN + 1, 7, step_rows(7, has_feed=True), False)
    bench.loop.expect(decode_step(other), INDEX, False)
    bench.coordinator.send(other)
    assert bench.run(7) is Ended.ANSWERED
    assert bench.coordinator.recv(LARGEST)[32:40] == struct.pack('<Q', RUN + 1)
    bench.coordinator.send(encoded(8))
    assert bench.run(8) is Ended.OTHER


def test_a_step_that_is_due_waits(bench):
    bench.coordinator.send(encoded(7))
    assert bench.run(7, until_ns=time.monotonic_ns()) is Ended.DUE
    assert bench.loop.done == 0 and bench.loop.has_step
    assert bench.run(7, until_ns=time.monotonic_ns() + 10**10) is Ended.ANSWERED
    assert bench.coordinator.recv(LARGEST) == bench.by_python(7)
    bench.coordinator.send(encoded(8))
    assert bench.run(8, until_ns=0) is Ended.DUE
    assert bench.loop.leave() is Ended.OTHER and bench.loop.done == 0
    assert bench.loop.take_step() == encoded(8)


def test_without_a_message_it_ends(bench):
    """After the socket's timeout, at the end of the other side, and without a socket."""
    begin = time.monotonic()
    assert bench.run(7, most=5) is Ended.NOTHING and not bench.loop.has_step
    assert time.monotonic() - begin >= 0.015
    bench.coordinator.close()
    assert bench.run(7) is Ended.NOTHING and bench.loop.done == 0
    bench.end.close()
    assert bench.run(7) is Ended.NOTHING


def test_an_answer_that_cannot_be_sent_is_left_with_its_tick(bench):
    bench.coordinator.send(encoded(7))
    bench.coordinator.shutdown(socket.SHUT_RD)
    assert bench.run(7) is Ended.UNSENT and bench.loop.done == 1
    bench.by_python(7)
    bench.actuator.end_ticks(1, 0)
    assert bench.actuator.snapshot() == bench.twin.snapshot()


def test_a_state_that_is_not_finite_is_that_of_python(bench):
    for actuator in bench.actuator, bench.twin:
        actuator.memory.continuous[0]['plant']['spool']['velocity'] = np.inf
    bench.coordinator.send(encoded(7))
    assert bench.run(7, most=4) is Ended.BROKEN and bench.loop.done == 1
    bench.coordinator.settimeout(0.01)
    with pytest.raises(TimeoutError):
        bench.coordinator.recv(1)
    with pytest.raises(SimulationDiverged) as by_python:
        bench.by_python(7)
    with pytest.raises(SimulationDiverged) as found:
        bench.actuator.end_ticks(1, bench.loop.broken)
    assert str(found.value) == str(by_python.value)


def test_other_steps_are_left(bench):
    bench.coordinator.send(encode_save(RUN, -1))
    assert bench.run(7) is Ended.OTHER and bench.loop.take_step() == encode_save(RUN, -1)
    rows = step_rows(7)
    rows.commands['kinds'][INDEX] = HAS_CLEAR_FAULT
    bench.coordinator.send(encode_tick(RUN, 7, rows, False))
    assert bench.run(7) is Ended.ANSWERED
