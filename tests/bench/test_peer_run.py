"""
Runs over the peer that Python brings along: the frames, the coordinator's end, the workers.

ZeroMQ, Cyclone DDS and HELICS carry the same frames between the same two loops; only the two
functions of their own file need what may not be installed.
"""

import ast
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
import inspect
from pathlib import Path
import tempfile
import threading

from isa_ros.actuator.actuator import Timing
from isa_ros.bench.peers import catalogue, frames
from isa_ros.bench.peers.catalogue import ends, peer, PEERS
from isa_ros.bench.peers.link import Link
from isa_ros.bench.peers.transport import PeerTransport
from isa_ros.bench.peers.worker import answer_steps
from isa_ros.bench.rigs import rigs_file
from isa_ros.config.run_config import RunConfig
from isa_ros.config.run_file import load_run
from isa_ros.core.signals import HAS_SETPOINT, LOAD_REPLY, SAMPLE, START
from isa_ros.errors import RunError
from isa_ros.run.exchange import Messages, Rows, Silence
from isa_ros.run.group import ActuatorGroup
from isa_ros.run.in_process import LocalTransport
from isa_ros.run.stepping import SteppedActuator
import numpy as np
import pytest

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


def timing(run: RunConfig) -> Timing:
    return Timing(run.step_ns, run.controller_offset_ns)


def starts(run: RunConfig) -> np.ndarray:
    rows = np.zeros(len(run.actuators), START)
    rows['position'] = [actuator.initial_position for actuator in run.actuators]
    rows['supply_pressure'] = 20.7e6
    return rows


def work(directory: Path, run: RunConfig, index: int) -> None:
    """Answer the steps of one run as a worker."""
    link = PIPES.worker_end(directory, index)
    try:
        answer_steps(link, SteppedActuator(run.actuators[index], timing(run)), index)
    finally:
        link.close()


@contextmanager
def over_pipes(run: RunConfig) -> Iterator[Link]:
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
            link.send(frames.encode_end())
            for worker in workers:
                worker.join(JOIN_S)
            link.close()
        assert not any(worker.is_alive() for worker in workers), 'the end reaches all'


def ticks(
        transport: PeerTransport | LocalTransport, n_actuators: int
        ) -> tuple[list[list[Messages]], bytes]:
    """Return the messages of a run of `TICKS`, and the replies and samples of its ticks."""
    rows, exchanged = Rows(n_actuators), b''
    rows.ports['supply_pressure'] = 20.7e6
    said = [[tuple(own) for own in transport.join(rows)]]
    transport.begin()
    for tick in range(TICKS):
        rows.commands.fill(0)
        if tick == SENT_OFF_AT:
            rows.commands[1] = (HAS_SETPOINT, 0, 0.06, 0.0, 0.0, np.nan, np.nan)
        transport.send(tick, rows)
        said.append([tuple(own) for own in transport.receive(rows)])
        exchanged += rows.replies.tobytes() + rows.samples.tobytes()
    return said, exchanged


def test_a_run_over_pipes_is_that_of_direct_calls_byte_for_byte(run):
    """Starts, ports, commands, replies, samples, applied setpoints and state messages."""
    with over_pipes(run) as link:
        over = ticks(PeerTransport(link, run, starts(run), lambda: None), 2)
    group = ActuatorGroup(run.actuators, timing(run))
    direct = ticks(LocalTransport(group, starts(run), Silence()), 2)
    assert over == direct
    moved = np.frombuffer(over[1][-2 * SAMPLE.itemsize:], SAMPLE)
    assert moved['position_reference'][1] == 0.06, 'the setpoint came through'


class Scripted:
    """A link whose answers to each step a test gives, in their order."""

    def __init__(self, answers: Callable[[frames.Step], Sequence[bytes]]) -> None:
        self._answers = answers
        self._arrived: list[bytes] = []

    def send(self, message: bytes) -> None:
        """Let the answers to a step arrive."""
        self._arrived += self._answers(frames.decode_step(message))

    def receive(self, timeout_s: float) -> bytes | None:
        """Return the next one."""
        return self._arrived.pop(0) if self._arrived else None

    def close(self) -> None:
        """Do nothing."""


def answered(worker: int, tick: int, force: float) -> bytes:
    reply = np.zeros(1, LOAD_REPLY)
    reply['force'] = force
    return frames.encode_answer(worker, tick, reply[0], np.zeros(1, SAMPLE)[0], (None, None))


def test_late_answers_to_an_earlier_start_do_not_count(run):
    """A worker that was slow to come up answers the first starts behind the third."""
    sent: list[int] = []

    def answers(step: frames.Step) -> list[bytes]:
        sent.append(step.tick)
        if len(sent) < 3:
            return [answered(0, step.tick, 1.0)]
        return [answered(1, -1, -9.0), answered(1, -2, -9.0), answered(1, step.tick, 2.0),
                answered(0, step.tick, 1.0)]
    rows = Rows(2)
    PeerTransport(Scripted(answers), run, starts(run), lambda: None).join(rows)
    assert sent == [-1, -2, -3]
    assert rows.replies['force'].tolist() == [1.0, 2.0]


def test_the_answer_to_another_tick_does_not_count(run):
    """Only what carries the tick's own number; without it the worker is named."""
    transport = PeerTransport(
        Scripted(lambda step: [answered(0, step.tick, 1.0), answered(1, step.tick - 1, -9.0)]),
        run, starts(run), lambda: None)
    transport.send(4, Rows(2))
    with pytest.raises(RunError, match=f'^{run.actuators[1].name}: no answer to tick 4$'):
        transport.receive(Rows(2))


@pytest.mark.parametrize('one', PEERS, ids=lambda one: one.name)
def test_every_peer_has_both_ends(one):
    """As `Ends` asks for them, also where the package that a file imports is not installed."""
    source = (Path(catalogue.__file__).parent / f'{one.module}.py').read_text()
    given = {node.name: [argument.arg for argument in node.args.args]
             for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)}
    for name in ('coordinator_end', 'worker_end'):
        wanted = list(inspect.signature(getattr(catalogue.Ends, name)).parameters)[1:]
        assert given[name] == wanted
