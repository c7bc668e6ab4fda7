"""
Runs over the peer that Python includes: the coordinator's end and the workers.

ZeroMQ, Cyclone DDS and HELICS carry the same bytes between the same two loops; only the two
functions of their own file need packages that may not be installed.
"""

import ast
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
import inspect
from pathlib import Path
import tempfile
import threading

from benchmarks.peers import catalogue
from benchmarks.peers.catalogue import ends, peer, PEERS
from benchmarks.peers.peer_end import PeerEnd
from benchmarks.peers.transport import PeerTransport, RUN_ID
from benchmarks.peers.worker import answer_steps
from isa_ros.actuator.actuator import SmartActuator
from isa_ros.bench.rigs import rigs_file
from isa_ros.config.assembly import group_of, surroundings_of, timing_of
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.signals import COMMAND, LOAD_REPLY, SAMPLE, START
from isa_ros.errors import RunError
from isa_ros.run.wire.answers import AnswerKind, encode_answer
from isa_ros.run.wire.parts import actuator_parts
from isa_ros.run.wire.steps import decode_step, encode_end, Step
from isa_ros.tick.exchange import Rows
from isa_ros.tick.in_process import InProcess
import numpy as np
import pytest
from tests.sheets import setpoint

PIPES = ends(peer('pipes'))
TICKS = 6
SENT_OFF_AT = 2  # tick at which the second actuator gets a setpoint
JOIN_S = 60.0


@pytest.fixture(scope='module')
def run(tmp_path_factory: pytest.TempPathFactory) -> RunConfig:
    """Return a run of two actuators of two kinds."""
    path = tmp_path_factory.mktemp('rigs') / 'rigs_2.yaml'
    path.write_text(rigs_file(2))
    return load_run(path)


def rows_of(run: RunConfig, transport: PeerTransport | InProcess) -> Rows:
    """Return the memory of a run at a supply pressure that lasts."""
    rows = Rows(len(run.actuators), surroundings_of(run), transport.group)
    rows.ports['supply_pressure'] = 20.7e6
    return rows


def starts(run: RunConfig) -> np.ndarray:
    rows = np.zeros(len(run.actuators), START)
    rows['position'] = [actuator.initial_position for actuator in run.actuators]
    rows['supply_pressure'] = 20.7e6
    return rows


def work(directory: Path, run: RunConfig, index: int) -> None:
    """Answer the steps of one run as a worker."""
    link = PIPES.worker_end(directory, index)
    try:
        answer_steps(link, SmartActuator(run.actuators[index], timing_of(run)), index)
    finally:
        link.close()


@contextmanager
def over_pipes(run: RunConfig) -> Iterator[PeerEnd]:
    """Return the coordinator's end of pipes to a thread for each actuator."""
    # The names of sockets are short, those of pytest's directories are not.
    with tempfile.TemporaryDirectory(prefix='isa_peer_') as name:
        link = PIPES.coordinator_end(Path(name), len(run.actuators))
        workers = [threading.Thread(target=work, args=(Path(name), run, k))
                   for k in range(len(run.actuators))]
        for worker in workers:
            worker.start()
        try:
            yield link
        finally:
            link.send(encode_end(RUN_ID))
            for worker in workers:
                worker.join(JOIN_S)
            link.close()
        assert not any(worker.is_alive() for worker in workers), 'the end reaches all'


def ticks(transport: PeerTransport | InProcess, run: RunConfig) -> list[tuple[bytes, ...]]:
    """Return what the actuators fill into the rows, at the start and in a run of `TICKS`."""
    rows = rows_of(run, transport)

    def filled() -> tuple[bytes, ...]:
        return rows.replies.tobytes(), rows.samples.tobytes(), rows.applied.tobytes()
    transport.join(rows)
    all_rows = [filled()]
    transport.begin()
    for tick in range(TICKS):
        rows.commands.fill(0)
        if tick == SENT_OFF_AT:
            rows.commands[1] = setpoint(position=0.06)
        transport.send(tick, rows)
        transport.receive(rows)
        all_rows.append(filled())
    return all_rows


def test_a_run_over_pipes_is_that_of_direct_calls_byte_for_byte(run):
    """Starts, ports, commands, replies, samples and applied setpoints."""
    with over_pipes(run) as link:
        over = ticks(PeerTransport(link, run, starts(run), lambda: None), run)
    direct = ticks(InProcess(group_of(run), starts(run)), run)
    assert over == direct
    _, samples, _ = over[-1]
    moved = np.frombuffer(samples, SAMPLE)
    assert moved['position_reference'][1] == 0.06, 'the setpoint came through'


class Scripted:
    """A link whose answers to each step a test gives, in their order."""

    def __init__(self, answers: Callable[[Step], Sequence[bytes]]) -> None:
        self._answers = answers
        self._arrived: list[bytes] = []

    def send(self, message: bytes) -> None:
        """Let the answers to a step arrive."""
        self._arrived += self._answers(decode_step(message))

    def receive(self, timeout_s: float) -> bytes | None:
        """Return the next one."""
        return self._arrived.pop(0) if self._arrived else None

    def close(self) -> None:
        """Do nothing."""


def answered(worker: int, tick: int, force: float) -> bytes:
    reply = np.zeros(1, LOAD_REPLY)
    reply['force'] = force
    return encode_answer(AnswerKind.DONE, RUN_ID, tick, worker, actuator_parts(
        reply, np.zeros(1, SAMPLE), np.zeros(1, COMMAND), {}))


def test_late_answers_to_an_earlier_start_do_not_count(run):
    """A worker that started slowly answers the first two hellos after the third."""
    sent: list[int] = []

    def answers(step: Step) -> list[bytes]:
        sent.append(step.tick)
        if len(sent) < 3:
            return [answered(0, step.tick, 1.0)]
        return [answered(1, 1, -9.0), answered(1, 2, -9.0), answered(1, step.tick, 2.0),
                answered(0, step.tick, 1.0)]
    transport = PeerTransport(Scripted(answers), run, starts(run), lambda: None)
    rows = rows_of(run, transport)
    transport.join(rows)
    assert sent == [1, 2, 3]
    assert rows.replies['force'].tolist() == [1.0, 2.0]


def test_the_answer_to_another_tick_does_not_count(run):
    """An answer counts by its tick; a worker without one is named."""
    transport = PeerTransport(
        Scripted(lambda step: [answered(0, step.tick, 1.0), answered(1, step.tick - 1, -9.0)]),
        run, starts(run), lambda: None)
    rows = rows_of(run, transport)
    transport.send(4, rows)
    with pytest.raises(RunError, match=f'^{run.actuators[1].name}: no answer to tick 4$'):
        transport.receive(rows)


@pytest.mark.parametrize('one', PEERS, ids=lambda one: one.name)
def test_every_peer_has_both_ends(one):
    """As `PeerModule` declares them, also where what a file imports is not installed."""
    source = (Path(catalogue.__file__).parent / f'{one.module}.py').read_text()
    given = {node.name: [argument.arg for argument in node.args.args]
             for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)}
    for name in ('coordinator_end', 'worker_end'):
        wanted = list(inspect.signature(getattr(catalogue.PeerModule, name)).parameters)[1:]
        assert given[name] == wanted
