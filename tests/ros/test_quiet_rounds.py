"""Quiet ticks of actuators in other processes: their bytes, and ticks that something ends."""

from collections.abc import Callable
from pathlib import Path
import socket
import time
from types import SimpleNamespace

from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.config.assembly import surroundings_of
from isa_ros.core.kernel import IS_COMPILED
from isa_ros.core.signals import HAS_SETPOINT
from isa_ros.nodes.lockstep import coordinator_end as lockstep, socket_rounds, steady_ticks
from isa_ros.nodes.lockstep.socket_rounds import _RECEIVE, _SEND, RoundEnds
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.run.provenance import provenance_of
from isa_ros.run.wire.board import are_possible
from isa_ros.scripting.run import load
from isa_ros.tick.exchange import Rows
from isa_ros.tick.source import ScheduledSource
from isa_ros.tick.tick_loop import TickLoop
import numpy as np
import pytest
from tests.ros.domains import held_domain, observing
from tests.ros.driven import driven, Robot
from tests.ros.lockstep.participants import NAMES
from tests.ros.started import DEADLINE_S
from tests.tick.quietly import advance

pytestmark = [pytest.mark.ros, pytest.mark.skipif(
    not IS_COMPILED, reason='quiet ticks are machine code')]
N_TICKS = 150
COMMANDS = (20, 21, 70)


def command(tick: int, out: np.ndarray) -> None:
    if tick in COMMANDS:
        out['kinds'][1], out['position'][1] = HAS_SETPOINT, 0.04 + 1e-4 * tick
        out['stiffness'][1] = out['damping'][1] = np.nan


def bag_of(directory: Path, observer, pattern: tuple[int, ...],
           act: Callable[[TickLoop, Robot], object] = lambda loop, robot: None,
           ) -> list[tuple[object, ...]]:
    """Return all messages of a run with so many ticks in successive calls."""
    run = load({'name': 'two', 'step_ms': 1.0, 'controller_offset_ms': 0.12,
                'supply': {'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0},
                'actuators': {name: {'model': 'isa_v5', 'load': {'kind': 'mass'}}
                              for name in NAMES}})
    config = run.configuration
    surroundings = surroundings_of(config)
    rows = Rows(2, surroundings)
    source = ScheduledSource(command, next_command=lambda tick: min(
        (own for own in COMMANDS if own >= tick), default=10**9))
    with driven(observer) as robot:
        loop = TickLoop(config.step_ns, robot.transport, surroundings, rows, source)
        packer = packer_of(config, rows.published)
        loop.join()
        act(loop, robot)
        with BagWriter(directory, packer.topics, provenance_of(
                run.simulation().scenario)) as bag:
            loop.sinks = (RunOutput(packer, config.step_ns, bag),)
            advance(SimpleNamespace(loop=loop), N_TICKS, pattern)
        robot.transport.close()
    return [(own.topic, own.sequence, own.t_ns, own.data) for own in Bag(directory).messages()]


def noted(patch: pytest.MonkeyPatch) -> list[int]:
    """Return where each call of quiet ticks has ended, among the parts of its actuators."""
    found: list[int] = []
    end = RoundEnds.end_quiet

    def note(self, tick, n_ticks, place):
        found.append(place)
        return end(self, tick, n_ticks, place)
    patch.setattr(RoundEnds, 'end_quiet', note)
    return found


@pytest.fixture
def places(monkeypatch) -> list[int]:
    """Return what is `noted` of a test."""
    return noted(monkeypatch)


@pytest.fixture(scope='module')
def expected(tmp_path_factory) -> list[tuple[object, ...]]:
    """Return the messages of single ticks, none of which is quiet."""
    with pytest.MonkeyPatch.context() as patch, held_domain(patch), observing(patch) as observer:
        patch.setattr(TickLoop, 'advance_quietly', lambda loop, until: None)
        places = noted(patch)
        found = bag_of(tmp_path_factory.mktemp('single') / 'bag', observer, (1,))
    assert not places and len(found) > 12 * N_TICKS
    return found


def test_a_bag_has_the_same_bytes_however_many_ticks_are_in_a_call(
        tmp_path, observer, places, expected):
    """Commands, devices that change, and chunks; most ticks are quiet."""
    for pattern in (1,), (3,), (20,), (100,), (10**6,):
        assert bag_of(tmp_path / str(pattern[0]), observer, pattern) == expected
    assert len(places) > 5 and min(places) < 0


def once(at: int, work: Callable[[TickLoop, Robot], object]) -> Callable[..., object]:
    """Return what does something once before the quiet ticks that follow a tick."""
    def act(loop: TickLoop, robot: Robot) -> None:
        advance_quietly = loop.advance_quietly

        def first(until: int) -> None:
            if loop.ticks >= at:
                loop.advance_quietly = advance_quietly
                work(loop, robot)
            advance_quietly(until)
        loop.advance_quietly = first
    return act


def delay(loop: TickLoop, robot: Robot, late_ones: slice = slice(None)) -> None:
    """Let actuators answer later than a wait for them lasts."""
    robot.transport._next_check = time.monotonic() + DEADLINE_S
    for end in robot.ends[late_ones]:
        serve = end._role.serve

        def late(serve=serve, end=end) -> None:
            end._role.serve = serve
            time.sleep(0.25)
            serve()
        end._role.serve = late


def delay_first(loop: TickLoop, robot: Robot) -> None:
    """Let the first be late, after the answer of the other has arrived."""
    delay(loop, robot, slice(1))


def hang_up(loop: TickLoop, robot: Robot) -> None:
    """Let one actuator end its connection before it answers, with a ring."""
    robot.transport._next_check = time.monotonic() + DEADLINE_S
    end = robot.ends[1]
    serve = end._role.serve

    def last() -> None:
        end._role.serve = serve
        end._wire.close()
        serve()
    end._role.serve = last


def vanish(loop: TickLoop, robot: Robot) -> None:
    """Let it do so as one whose process is killed."""
    hang_up(loop, robot)
    robot.ends[1]._wire.ring = lambda: None


def hang_up_sooner(loop: TickLoop, robot: Robot) -> None:
    """Let it do so and answer at the board, before another one, which is late, has answered."""
    delay_first(loop, robot)
    hang_up(loop, robot)


def shut(loop: TickLoop, robot: Robot) -> None:
    """End the connection of one actuator."""
    robot.transport._next_check = time.monotonic() + DEADLINE_S
    robot.ends[1]._wire._socket.shutdown(socket.SHUT_RDWR)


def close_ours(loop: TickLoop, robot: Robot) -> None:
    """Let no answer of one actuator arrive."""
    robot.transport._next_check = time.monotonic() + DEADLINE_S
    ours = robot.transport._wires
    ours._ends[ours.numbers()[0]].shutdown(socket.SHUT_RD)


@pytest.fixture(params=['board', 'sockets'])
def carrier(request, monkeypatch) -> str:
    """Let actuators look often at what has arrived, and return where they get their ticks."""
    monkeypatch.setattr(lockstep, 'REPEAT_S', 1e6)
    monkeypatch.setattr(steady_ticks, 'QUIET_NS', 1_000_000)
    if request.param == 'sockets':
        monkeypatch.setattr(socket_rounds, 'are_possible', lambda: False)
    elif not are_possible():
        pytest.skip('a board needs Linux')
    return request.param


@pytest.mark.parametrize(('work', 'place'), [
    (delay, _RECEIVE), (delay_first, _RECEIVE), (hang_up, _RECEIVE), (vanish, _RECEIVE),
    (hang_up_sooner, _RECEIVE)])
def test_a_tick_that_cannot_end_in_the_loop_is_ended_by_python(
        tmp_path, observer, expected, carrier, places, work, place):
    """
    Late answers, and actuators that leave: the same bytes, then by the topics, at once.

    On a busy host it may happen in a tick that Python has begun: then once more.
    """
    for k in range(5):
        assert bag_of(tmp_path / str(k), observer, (30,), once(40, work)) == expected
        if place in places:
            return
    raise AssertionError(places)


@pytest.mark.parametrize(('work', 'place'), [(shut, _SEND), (close_ours, _RECEIVE)])
def test_connections_that_are_lost_matter_where_ticks_use_them(
        tmp_path, observer, expected, carrier, places, work, place):
    """At the board they are only for what is rare; a busy host makes some answers late there."""
    assert bag_of(tmp_path / 'bag', observer, (30,), once(40, work)) == expected
    assert place in places or carrier == 'board'


def test_an_answer_with_a_changed_parameter_is_left_to_python(
        tmp_path, observer, carrier, places):
    """On a busy host it may come in a tick that Python has begun: then once more."""
    def tune(loop: TickLoop, robot: Robot) -> None:
        robot.transport._next_check = time.monotonic() + DEADLINE_S
        serve = robot.ends[0]._role.serve

        def tuned() -> None:
            robot.ends[0]._role.serve = serve
            robot.nodes[0].actuator.tune({'force.kp': 9e-8})
            serve()
        robot.ends[0]._role.serve = tuned
    for k in range(5):
        found = bag_of(tmp_path / str(k), observer, (30,), once(40, tune))
        ticks = [own[1] for own in found if own[0] == f'/{NAMES[0]}/applied_parameters']
        assert sum(tick > 40 for tick in ticks) == 1
        if _RECEIVE in places:
            return
    raise AssertionError(places)


def test_no_ticks_are_quiet_while_the_topics_are_due(tmp_path, observer, places, monkeypatch):
    monkeypatch.setattr(lockstep, 'TOPIC_CHECK_S', 0.0)
    bag_of(tmp_path / 'bag', observer, (30,))
    assert not places
