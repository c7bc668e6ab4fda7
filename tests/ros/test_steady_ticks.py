"""Real actuators whose ticks run in the compiled loop, in a run with a coordinator."""

import time

from isa_ros.config.runs.default_actuator import DEFAULT_TIMING
from isa_ros.core.kernel import IS_COMPILED
from isa_ros.errors import SimulationDiverged
from isa_ros.nodes.lockstep import (
    coordinator_end as lockstep, participant_end as participant, socket_rounds,
    steady_ticks as steady)
from isa_ros.nodes.lockstep.steady_ticks import SteadyTicks
from isa_ros.nodes.middleware.qos import KEPT
from isa_ros.run.wire.board import are_possible
from isa_ros.run.wire.coordinating import TickRound
from isa_ros.run.wire.steps import encode_begin, encode_tick, StepKind
from msg_adapters.actuator_messages import APPLIED_PLACE
from msg_adapters.cdr_reader import decode
import numpy as np
import pytest
from sensor_msgs.msg import JointState
from tests.ros.driven import driven, noted
from tests.ros.started import wait_for

pytestmark = [pytest.mark.ros, pytest.mark.skipif(
    not IS_COMPILED, reason='the loop is machine code')]


def target(tick: int) -> float | None:
    return 0.03 if tick == 20 else None


def command_at(tick: int) -> float | None:
    return 0.03 + 1e-5 * tick if 20 <= tick < 70 else None


@pytest.fixture
def looped(monkeypatch) -> list[int]:
    """Return how many ticks each call of a loop has run."""
    done: list[int] = []
    run = SteadyTicks.run

    def note(self, *given):
        ended = run(self, *given)
        done.append(self.done)
        return ended
    monkeypatch.setattr(SteadyTicks, 'run', note)
    return done


def test_a_run_is_the_same_with_and_without_the_loop(observer, looped):
    with driven(observer, is_looped=False) as robot:
        expected = [robot.tick(k, target(k)) for k in range(80)]
        robot.transport.close()
    assert looped == []
    with driven(observer) as robot:
        assert [robot.tick(k, target(k)) for k in range(80)] == expected
        robot.transport.close()
    assert sum(looped) > 2 * 60


@pytest.mark.skipif(not are_possible(), reason='a board needs Linux')
def test_a_run_at_the_board_is_the_same_as_by_socket(observer, looped, monkeypatch):
    """At the board from the first ticks on, those that Python answers too."""
    found, posted = [], []
    for is_at_board in True, False:
        monkeypatch.setattr(socket_rounds, 'are_possible', lambda at=is_at_board: at)
        with driven(observer) as robot:
            found.append([robot.tick(k, target(k)) for k in range(80)])
            posted.append(int(robot.transport._rounds._board.head['posted'][0]))
            robot.transport.close()
    assert found[0] == found[1] and posted[0] > 60 and posted[1] == 0


def test_a_repeated_step_is_answered_again_without_another_tick(observer, looped, monkeypatch):
    """Its answer is that of the loop, from the topic."""
    with driven(observer) as robot:
        for k in range(30):
            before = robot.tick(k)
        sent: list[bytes] = []
        for end in robot.ends:
            monkeypatch.setattr(end, '_send_answer', sent.append)
        monkeypatch.setattr(lockstep, 'REPEAT_S', 0.0)
        robot.transport._send(encode_tick(robot.transport._run_id, 29, robot.rows, False))
        wait_for(lambda: len(sent) == 2, 'both repetitions')
        for own in sent:
            index = own[20]
            assert own[28] == 1     # is repeated
            row = robot.rows.replies[index:index + 1].tobytes()
            assert row in own and row in before
        steps = 30 * DEFAULT_TIMING.steps
        assert [int(own.actuator.ticked.clock[0]) for own in robot.nodes] == [steps, steps]
    assert looped


def test_a_state_that_breaks_in_the_loop_ends_the_run(observer, looped):
    with driven(observer) as robot:
        for k in range(10):
            robot.tick(k)
        kfe = robot.nodes[1].actuator
        kfe.memory.continuous[0]['plant']['spool']['velocity'] = np.inf
        with pytest.raises(SimulationDiverged, match='kfe: .*') as found:
            robot.tick(10)
        assert found.value.t_ns == 11_000_000 and looped


def test_a_setpoint_of_a_publisher_takes_effect(observer, looped):
    """The loop of its actuator notices it, and no other does."""
    with driven(observer) as robot:
        ticks = iter(range(10**6))
        for _ in range(30):
            robot.tick(next(ticks))
        publisher = observer.create_publisher(JointState, '/kfe/setpoint', 10)

        def has_effect() -> bool:
            publisher.publish(JointState(name=['kfe'], position=[0.033]))
            robot.tick(next(ticks))
            return bool(robot.rows.applied['kinds'][1])
        wait_for(has_effect, 'the setpoint')
        assert robot.rows.applied['position'].tolist()[1] == 0.033
        assert not robot.rows.applied['kinds'][0]
        assert robot.nodes[1].is_watched() and not robot.nodes[0].is_watched()
        assert looped


def test_another_run_over_the_same_rows_is_the_same(observer, looped):
    """It has sockets and an id of its own."""
    with driven(observer) as robot:
        first = [robot.tick(k, target(k)) for k in range(30)]
        robot.join()
        assert [robot.tick(k, target(k)) for k in range(30)] == first
        assert robot.transport._wires.is_open
        robot.transport.close()
    assert looped


def test_the_rounds_of_the_coordinator_are_those_of_python(observer, monkeypatch):
    """With real actuators: the same rows, and rounds that were taken."""
    taken = []
    take = TickRound.take

    def note(self):
        taken.append(1)
        take(self)
    monkeypatch.setattr(TickRound, 'take', note)
    monkeypatch.setattr(lockstep, 'TOPIC_CHECK_S', 100.0)
    results = []
    for are_rounds in True, False:
        with driven(observer) as robot:
            robot.transport._rounds._are_possible = are_rounds
            results.append([robot.tick(k, target(k)) for k in range(50)])
            robot.transport.close()
        assert 40 <= len(taken) <= 50   # all but those with a changed parameter and the first
    assert results[0] == results[1]


def test_what_is_kept_for_later_subscriptions_is_the_same(observer, looped):
    """The last applied setpoints, in their order, with a command at every tick of a while."""
    found = []
    for is_looped in True, False:
        with driven(observer, is_looped) as robot:
            messages: list[tuple[int, bytes]] = []
            for k in range(10):
                robot.tick(k)
            robot.transport.snapshots()     # after all before it has been published
            noted(robot.nodes[1].outlet, False, messages)
            for k in range(10, 100):
                robot.tick(k, command_at(k))
            robot.transport.snapshots()
            found.append(messages)
            robot.transport.close()
    assert found[0][-KEPT.depth:] == found[1][-KEPT.depth:] and len(found[1]) == 50
    kept = set(found[1])
    assert found[0] == [own for own in found[1] if own in set(found[0])] and kept >= set(found[0])
    assert max(looped) > 5


def test_a_subscription_receives_all_setpoints_since_the_last_ones_that_are_kept(
        observer, looped, monkeypatch):
    """One that came while they were kept: without a gap, as without the loop."""
    monkeypatch.setattr(steady, 'KEPT_NS', 10**12)
    found = []
    for is_looped in True, False:
        with driven(observer, is_looped) as robot:
            messages: list[tuple[int, bytes]] = []
            for k in range(22):
                robot.tick(k, command_at(k))
            robot.transport.snapshots()
            noted(robot.nodes[1].outlet, True, messages)
            for k in range(22, 100):
                robot.tick(k, command_at(k))
            robot.transport.snapshots()
            found.append(messages)
            robot.transport.close()
    assert found[0] == found[1] and len(found[0]) == 48
    assert max(looped) > 5


def test_what_is_kept_is_published_when_no_message_comes(observer, looped, monkeypatch):
    """A run that waits shows its last setpoint to a later subscription."""
    monkeypatch.setattr(steady, 'KEPT_NS', 10**12)
    monkeypatch.setattr(participant, 'TOPIC_CHECK_S', 100.0)
    with driven(observer) as robot:
        messages: list[tuple[int, bytes]] = []
        noted(robot.nodes[1].outlet, False, messages)
        for k in range(30):
            robot.tick(k, command_at(k))

        def applied() -> list[float]:
            return [decode(data, JointState).position[0] for slot, data in [*messages]
                    if slot == APPLIED_PLACE]
        wait_for(lambda: applied()[-1:] == [command_at(29)], 'the last setpoint')
        robot.transport.close()
    assert max(looped) > 5


def test_ticks_of_the_loop_are_a_sign_of_the_coordinator(observer, looped, monkeypatch):
    """Otherwise the run would count as abandoned after a while."""
    monkeypatch.setattr(lockstep, 'TOPIC_CHECK_S', 100.0)
    with driven(observer) as robot:
        for k in range(30):
            robot.tick(k)
        before = time.monotonic()
        for k in range(30, 60):
            robot.tick(k)
        wait_for(lambda: all(end._last_message >= before for end in robot.ends), 'the sign')
    assert sum(looped) > 60


def test_an_announcement_of_the_run_leaves_its_ticks_to_the_loop(observer, looped, monkeypatch):
    """The bytes are those without it; a begin that names others ends the run for the loop too."""
    with driven(observer) as robot:
        expected = [robot.tick(k, target(k)) for k in range(60)]
        robot.transport.close()
    with driven(observer) as robot:
        seen: list[tuple[StepKind, int]] = []
        for k, end in enumerate(robot.ends):
            handle = end._handle
            monkeypatch.setattr(end, '_handle', lambda step, k=k, handle=handle: (
                handle(step), seen.append((step.kind, k))))
        found = [robot.tick(k, target(k)) for k in range(30)]
        seen.clear()
        robot.transport._announce()
        wait_for(lambda: {(StepKind.BEGIN, 0), (StepKind.BEGIN, 1)} <= {*seen}, 'it')
        assert all(end._ticks.are_next for end in robot.ends)
        found += [robot.tick(k, target(k)) for k in range(30, 60)]
        assert found == expected and StepKind.TICK not in dict(seen)
        transport = robot.transport
        transport._send(encode_begin(transport._run_id, [bytes(8)] * 2))
        wait_for(lambda: not any(end._ticks.are_next for end in robot.ends), 'the other begin')


@pytest.mark.parametrize('is_foreign', [False, True], ids=['a save', 'a tick of another run'])
def test_after_another_step_the_next_tick_is_checked_by_python(observer, is_foreign):
    with driven(observer) as robot:
        for k in range(30):
            robot.tick(k)
        assert all(end._ticks.are_next for end in robot.ends)
        if is_foreign:
            transport = robot.transport
            transport._send(encode_tick(transport._run_id ^ 1, 29, robot.rows, False))
        else:
            robot.transport.snapshots()
        wait_for(lambda: not any(end._ticks.are_next for end in robot.ends), 'another step')
        robot.tick(30)
