"""A run over a peer: the coordinator's transport, and the workers it starts."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
import os
from pathlib import Path
import subprocess
import sys
import tempfile

from benchmarks.peers.catalogue import ends, Peer, peer
from benchmarks.peers.peer_end import PeerEnd
from benchmarks.peers.worker import load_kernels
from isa_ros.bench.child import environment
from isa_ros.config.assembly import surroundings_of
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.parent import PARENT_VARIABLE
from isa_ros.core.signals import Records
from isa_ros.errors import RunError
from isa_ros.processes.stopping import StopRequest
from isa_ros.run.options import Request
from isa_ros.run.outlets import Outlets
from isa_ros.run.session import prepare, record, Report, Session
from isa_ros.run.wire.answers import Answer, decode_answer
from isa_ros.run.wire.parts import take_actuator_parts
from isa_ros.run.wire.roster import Roster
from isa_ros.run.wire.steps import encode_end, encode_hello, encode_tick
from isa_ros.tick.exchange import IDLE_S, Rows

START_PERIOD_S = 0.05
SLICE_S = 0.5
JOIN_SLICES = 1200      # hellos before tick 0: a minute
TICK_SLICES = 20        # waits for a tick: ten seconds
END_S = 5.0
RUN_ID = 1              # any: a link has only one run
_NOT_SUPPORTED = 'a run over a peer cannot be paused or saved'


class PeerTransport:
    """A `Transport` to the workers of a `PeerEnd`, with the messages of the private wire."""

    group = None
    is_quiet = False
    ends = None

    def __init__(
            self, link: PeerEnd, run: RunConfig, starts: Records,
            lost: Callable[[], str | None]) -> None:
        self._link = link
        self._roster = Roster(
            [actuator.name for actuator in run.actuators],
            [supply.name for supply in run.supplies], {})
        self._step_ns = run.step_ns
        self._starts = starts
        self._lost = lost
        self._tick = 0

    def join(self, rows: Rows) -> None:
        """Send hellos until all workers have answered the same one."""
        for count in range(1, JOIN_SLICES + 1):
            self._link.send(
                encode_hello(RUN_ID, count, self._step_ns, self._starts, self._roster))
            answers = self._answers(count, START_PERIOD_S, slices=1)
            if len(answers) == len(self._roster.names):
                self._take(answers, rows)
                return
        raise RunError(f'{self._missing(answers)}: no answer before tick 0')

    def begin(self) -> None:
        """Do nothing: no worker publishes."""

    def send(self, tick: int, rows: Rows) -> None:
        """Send the step of a tick."""
        self._tick = tick
        self._link.send(encode_tick(RUN_ID, tick, rows, has_controllers=False))

    def receive(self, rows: Rows) -> None:
        """Wait for every worker."""
        answers = self._answers(self._tick, SLICE_S, TICK_SLICES)
        if len(answers) < len(self._roster.names):
            raise RunError(f'{self._missing(answers)}: no answer to tick {self._tick}')
        self._take(answers, rows)

    def idle(self, seconds: float = IDLE_S) -> None:
        """Raise: a run over a peer supports neither pause nor saved states."""
        raise RunError(_NOT_SUPPORTED)

    def snapshots(self) -> list[bytes]:
        """Raise: a run over a peer supports neither pause nor saved states."""
        raise RunError(_NOT_SUPPORTED)

    def restore(self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> None:
        """Raise: a run over a peer supports neither pause nor saved states."""
        raise RunError(_NOT_SUPPORTED)

    def _take(self, answers: dict[int, Answer], rows: Rows) -> None:
        """Fill the rows from the answers of all workers."""
        rows.tuned = {}
        for k, answer in answers.items():
            take_actuator_parts(answer.parts, k, rows)

    def _answers(self, tick: int, timeout_s: float, slices: int) -> dict[int, Answer]:
        """Return the answers to one step; give up after ``slices`` waits without a message."""
        answers: dict[int, Answer] = {}
        while len(answers) < len(self._roster.names) and slices:
            data = self._link.receive(timeout_s)
            if data is None:
                slices -= 1
                if (lost := self._lost()) is not None:
                    raise RunError(lost)
                continue
            answer = decode_answer(data)
            if answer.tick == tick:
                answers[answer.participant] = answer
        return answers

    def _missing(self, answers: dict[int, Answer]) -> str:
        return ', '.join(name for k, name in enumerate(self._roster.names) if k not in answers)


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
        """Return a text that names a worker that has ended; None: all are running."""
        for actuator, process in zip(self._session.run.actuators, self._running):
            if process.poll() is not None:
                return f'{actuator.name}: its worker ended with exit code {process.returncode}'
        return None


def bench_over(name: str, request: Request, report: Report) -> None:
    """Do a measured run over the peer of that name, until its end or Ctrl-C."""
    with StopRequest() as should_stop:
        run_over(peer(name), prepare(request), report, should_stop)


def run_over(
        peer: Peer, session: Session, report: Report | None, should_stop: StopRequest) -> None:
    """Run and record a prepared session over a peer."""
    load_kernels(session.run)
    surroundings = surroundings_of(session.run)
    with tempfile.TemporaryDirectory(prefix='isa_bench_') as directory:
        with _open(peer, Path(directory), len(session.run.actuators)) as link, \
                Workers(session, peer, Path(directory)) as workers:
            transport = PeerTransport(link, session.run, surroundings.starts(), workers.lost)
            try:
                record(session, transport, surroundings, lambda topics: Outlets(), report,
                       should_stop)
            finally:
                link.send(encode_end(RUN_ID))


@contextmanager
def _open(peer: Peer, directory: Path, n_workers: int) -> Iterator[PeerEnd]:
    link = ends(peer).coordinator_end(directory, n_workers)
    try:
        yield link
    finally:
        link.close()
