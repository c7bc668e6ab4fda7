"""Messages to a worker and back, and workers that do not answer."""

from collections.abc import Callable

from benchmarks.peers.catalogue import peer
from benchmarks.peers.transport import PeerTransport
from benchmarks.peers.worker import answer_steps
from isa_ros.actuator.actuator import SmartActuator
from isa_ros.config.assembly import surroundings_of, timing_of
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.errors import ConfigError, RunError
from isa_ros.run.wire.answers import Answer, AnswerKind, decode_answer, encode_answer
from isa_ros.run.wire.parts import actuator_parts, take_actuator_parts
from isa_ros.run.wire.roster import Roster
from isa_ros.run.wire.steps import decode_step, encode_end, encode_hello, encode_tick, StepKind
from isa_ros.tick.exchange import Rows
import pytest
from tests.sheets import setpoint


class Script:
    """A link whose worker gets some steps, one after the other, and keeps what it answers."""

    def __init__(self, *steps: bytes) -> None:
        self._steps: list[bytes | None] = [None, *steps]  # the first wait is in vain
        self.sent: list[bytes] = []

    def send(self, message: bytes) -> None:
        """Keep an answer."""
        self.sent.append(message)

    def receive(self, timeout_s: float) -> bytes | None:
        """Return the next step."""
        return self._steps.pop(0)

    def answers(self) -> list[Answer]:
        """Return what was answered."""
        return [decode_answer(data) for data in self.sent]


def test_a_worker_does_what_an_actuator_of_the_run_does(leg):
    """From its row of starts, under its rows of ports and commands, until the end."""
    surroundings = surroundings_of(leg)
    starts, exchange = surroundings.starts(), Rows(3, surroundings)
    surroundings.ports(exchange.ports)
    exchange.commands[1] = setpoint(position=0.03)
    index, roster = 1, Roster([own.name for own in leg.actuators], ['supply'], {})
    link = Script(encode_hello(1, 4, leg.step_ns, starts, roster),
                  encode_tick(1, 0, exchange, False), encode_end(1))
    worker, own = (SmartActuator(leg.actuators[index], timing_of(leg)) for _ in range(2))
    answer_steps(link, worker, index)
    taken = Rows(3, surroundings)
    own.start(*starts[index].item())
    for answer, tick in zip(link.answers(), (4, 0), strict=True):
        assert (answer.kind, answer.run_id, answer.tick, answer.participant) == (
            AnswerKind.DONE, 1, tick, index)
        take_actuator_parts(answer.parts, index, taken)
        assert taken.samples[index].tobytes() == own.sample.tobytes()
        assert taken.replies[index].tobytes() == own.reply.tobytes()
        assert taken.applied[index].tobytes() == own.memory.applied.tobytes()
        own.accept(exchange.commands[index])
        own.tick(exchange.ports[index])
    assert taken.applied[index]['position'] == 0.03


class Silence:
    """A link without answers."""

    def send(self, message: bytes) -> None:
        """Discard the message."""

    def receive(self, timeout_s: float) -> bytes | None:
        """Return at once."""
        return None

    def close(self) -> None:
        """Do nothing: there is nothing to release."""


class Echo(Silence):
    """A link whose three workers answer at once, with what they were told, and an old answer."""

    def __init__(self) -> None:
        self._answers: list[bytes] = []
        self.kinds: list[StepKind] = []

    def send(self, message: bytes) -> None:
        """Answer for all, the last one first."""
        step = decode_step(message)
        self.kinds.append(step.kind)
        if step.kind is StepKind.END:
            return
        rows = Rows(1, surroundings_of(load_run(find('rig_rotary.yaml', CONFIG))))
        for k in reversed(range(step.rows)):
            rows.samples['position'] = (
                step.start(k) if step.kind is StepKind.HELLO else step.command(k))['position']
            parts = actuator_parts(
                rows.replies, rows.samples, rows.applied, {'force.kp': 1e-7} if k == 2 else {})
            self._answers += [
                encode_answer(AnswerKind.DONE, step.run_id, tick, k, parts)
                for tick in (step.tick - 1, step.tick)]

    def receive(self, timeout_s: float) -> bytes | None:
        """Return the next answer."""
        return self._answers.pop(0) if self._answers else None


@pytest.fixture(scope='module')
def leg() -> RunConfig:
    """Return a run of three actuators."""
    return load_run(find('leg.yaml', CONFIG))


def nothing_lost() -> None:
    """Return None: all workers run."""


def made(
        link: Silence, run: RunConfig,
        lost: Callable[[], str | None] = nothing_lost) -> tuple[PeerTransport, Rows]:
    """Return a transport, and the rows it fills."""
    surroundings = surroundings_of(run)
    return PeerTransport(link, run, surroundings.starts(), lost), Rows(3, surroundings)


def test_the_rows_of_all_workers_are_filled(leg):
    """Each answer into its own row, those to other steps left out."""
    link = Echo()
    transport, rows = made(link, leg)
    starts = surroundings_of(leg).starts()
    transport.join(rows)
    assert rows.samples['position'].tolist() == starts['position'].tolist()
    assert rows.tuned == {2: {'force.kp': 1e-7}}
    transport.begin()
    rows.commands['position'] = 0.1, 0.2, 0.3
    transport.send(5, rows)
    transport.receive(rows)
    assert rows.samples['position'].tolist() == [0.1, 0.2, 0.3]
    assert link.kinds == [StepKind.HELLO, StepKind.TICK]


def test_a_worker_that_ended_is_named(leg):
    transport, rows = made(Silence(), leg, lambda: 'hfe: its worker ended')
    with pytest.raises(RunError, match='hfe: its worker ended'):
        transport.join(rows)


def test_workers_that_never_answer_are_named(leg):
    transport, rows = made(Silence(), leg)
    with pytest.raises(RunError, match='haa, hfe, kfe: no answer before tick 0'):
        transport.join(rows)
    transport.send(3, rows)
    with pytest.raises(RunError, match='haa, hfe, kfe: no answer to tick 3'):
        transport.receive(rows)


@pytest.mark.parametrize('ask', [
    lambda transport, rows: transport.idle(), lambda transport, rows: transport.snapshots(),
    lambda transport, rows: transport.restore(0, [], rows)])
def test_what_a_peer_cannot_do_is_refused(leg, ask):
    with pytest.raises(RunError, match='a run over a peer cannot be paused or saved'):
        ask(*made(Silence(), leg))


def test_a_wrong_peer_is_answered_with_the_right_one():
    with pytest.raises(ConfigError, match='did you mean zeromq?'):
        peer('zeromk')
