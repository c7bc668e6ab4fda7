"""A run over a peer: the coordinator's side of it, and the workers it starts."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
import os
from pathlib import Path
import subprocess
import sys
import tempfile

from isa_ros.bench.child import environment
from isa_ros.bench.peers.catalogue import ends, Peer
from isa_ros.bench.peers.frames import Answer, decode_answer, encode_end, encode_start, encode_tick
from isa_ros.bench.peers.link import Link
from isa_ros.bench.peers.worker import settle
from isa_ros.config.run_config import RunConfig
from isa_ros.errors import RunError
from isa_ros.processes.stopping import PARENT_VARIABLE, StopRequest
from isa_ros.run.exchange import Messages, Records, Rows, Silence
from isa_ros.run.group import by_actuator, state_messages
from isa_ros.run.session import record, Report, Session
from isa_ros.surroundings.surroundings import SharedLoad

START_PERIOD_S = 0.05
SLICE_S = 0.5
JOIN_SLICES = 1200      # of a start: a minute
TICK_SLICES = 20        # ten seconds
END_S = 5.0
_NOT_HERE = 'a peer runs to its end: no pause, no saved state'


class PeerTransport(Silence):
    """Steps and answers of a run over a `Link`; nobody else listens to a message."""

    def __init__(
            self, link: Link, run: RunConfig, starts: Records,
            lost: Callable[[], str | None]) -> None:
        self._link = link
        self._names = [actuator.name for actuator in run.actuators]
        self._states = state_messages(run.actuators)
        self._step_ns = run.step_ns
        self._starts = starts
        self._lost = lost
        self._tick = 0

    def join(self, rows: Rows) -> Sequence[Messages]:
        """Send starts until all workers have answered the same one."""
        for count in range(1, JOIN_SLICES + 1):
            self._link.send(encode_start(count, self._starts))
            answers = self._answers(-count, START_PERIOD_S, slices=1)
            if len(answers) == len(self._names):
                return self._said(answers, rows, 0)
        raise RunError(f'{self._missing(answers)}: no answer before tick 0')

    def begin(self) -> None:
        """Let nobody publish."""

    def send(self, tick: int, rows: Rows) -> None:
        """Send the step."""
        self._tick = tick
        self._link.send(encode_tick(tick, rows.ports, rows.commands))

    def receive(self, rows: Rows) -> Sequence[Messages]:
        """Wait for every worker."""
        answers = self._answers(self._tick, SLICE_S, TICK_SLICES)
        if len(answers) < len(self._names):
            raise RunError(f'{self._missing(answers)}: no answer to tick {self._tick}')
        return self._said(answers, rows, (self._tick + 1) * self._step_ns)

    def idle(self) -> None:
        """Refuse what no bench asks for."""
        raise RunError(_NOT_HERE)

    def snapshots(self) -> list[bytes]:
        """Refuse what no bench asks for."""
        raise RunError(_NOT_HERE)

    def restore(
            self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> Sequence[Messages]:
        """Refuse what no bench asks for."""
        raise RunError(_NOT_HERE)

    def _said(self, answers: dict[int, Answer], rows: Rows, t_ns: int) -> Sequence[Messages]:
        """Take what the workers say and return the messages of each at ``t_ns``."""
        for k, answer in answers.items():
            rows.replies[k], rows.samples[k] = answer.reply, answer.sample
        states = by_actuator(self._states.pack(rows.samples, t_ns))
        return [(*answers[k].messages, *own) for k, own in enumerate(states)]

    def _answers(self, tick: int, timeout_s: float, slices: int) -> dict[int, Answer]:
        """Return the answers to one step that come before ``slices`` waits were in vain."""
        answers: dict[int, Answer] = {}
        while len(answers) < len(self._names) and slices:
            data = self._link.receive(timeout_s)
            if data is None:
                slices -= 1
                if (lost := self._lost()) is not None:
                    raise RunError(lost)
                continue
            answer = decode_answer(data)
            if answer.tick == tick:
                answers[answer.worker] = answer
        return answers

    def _missing(self, answers: dict[int, Answer]) -> str:
        return ', '.join(name for k, name in enumerate(self._names) if k not in answers)


class Workers:
    """One process per actuator; a context manager."""

    def __init__(self, session: Session, peer: Peer, directory: Path) -> None:
        self._session = session
        self._peer = peer
        self._directory = directory
        self._running: list[subprocess.Popen[bytes]] = []

    def __enter__(self) -> 'Workers':
        request = self._session.request
        inherited = environment({PARENT_VARIABLE: str(os.getpid())})
        files = [str(request.config.resolve())]
        if request.scenario is not None:
            files.append(str(request.scenario.resolve()))
        for index in range(len(self._session.run.actuators)):
            self._running.append(subprocess.Popen(
                [sys.executable, '-m', f'{__package__}.worker', self._peer.name,
                 str(self._directory), str(index), *files],
                env=inherited, stdin=subprocess.DEVNULL, start_new_session=True))
        return self

    def __exit__(self, *_: object) -> None:
        for process in self._running:
            try:
                process.wait(END_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def lost(self) -> str | None:
        """Say which worker has ended; None: all run."""
        for actuator, process in zip(self._session.run.actuators, self._running):
            if process.poll() is not None:
                return f'{actuator.name}: its worker ended with exit code {process.returncode}'
        return None


def run_over(
        peer: Peer, session: Session, report: Report | None, should_stop: StopRequest) -> None:
    """Run and record what was prepared, over a peer."""
    settle(session.run)
    load = SharedLoad(session.run)
    with tempfile.TemporaryDirectory(prefix='isa_bench_') as directory:
        with _open(peer, Path(directory), len(session.run.actuators)) as link, \
                Workers(session, peer, Path(directory)) as workers:
            transport = PeerTransport(link, session.run, load.starts(session.run), workers.lost)
            try:
                record(session, transport, load, report, should_stop)
            finally:
                link.send(encode_end())


@contextmanager
def _open(peer: Peer, directory: Path, n_workers: int) -> Iterator[Link]:
    link = ends(peer).coordinator_end(directory, n_workers)
    try:
        yield link
    finally:
        link.close()
