"""The end of a run under a fault: its message, its delay, and what is left behind."""

from pathlib import Path
import re
import time
from typing import NamedTuple

from isa_ros.bag.reader import Bag
from isa_ros.cli.main import main
from isa_ros.processes.processes import END_S
from mcap.writer import MCAP0_MAGIC
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from tests.ros.bags import mcap_file
from tests.ros.started import DEADLINE_S, is_alive, RIG, Started, wait_for

KILL_SEEN_S = 1.0  # promised: a process that has ended is noticed within it
SETTLE_S = 1.5  # of the bag and of this process, on two loaded cores
LOOK_S = 0.01
ONE_SECOND_NS = 1_000_000_000
WHEEL_SINE = '--scenario', 'wheel_sine', '--duration', '2'
_SHARED_MEMORY = re.compile(r'/dev/shm/(?:sem\.)?fast(?:rtps|dds)_\S+')


class Ended(NamedTuple):
    """The end of a run."""

    exit_code: int
    line: str
    """The command's message; any other line must be a node's log."""
    detected_s: float
    """From the fault to the end of the bag."""
    ended_s: float
    """From the fault to the end of the last process."""


class Fault:
    """
    One fault of a run: construct it right before causing the fault, or call `begin` then.

    ``bag`` is None if the run ends before a bag is created.
    """

    def __init__(self, run: Started, bag: Path | None) -> None:
        self.children = run.children()
        self.pids = [run.pid, *self.children.values()]
        self._run = run
        self._file = None if bag is None else mcap_file(bag)
        self._segments = set().union(*map(shared_memory, self.pids))
        self._begin = time.monotonic()

    def begin(self) -> None:
        """Set the begin of the fault to now."""
        self._begin = time.monotonic()

    def ended(self, within_s: float) -> Ended:
        """
        Wait for the end and return it; check that no part of the run is left.

        ``within_s`` is the promised time to detect, after which the bag is closed and the
        children are given `END_S`.
        """
        detected = None
        while not self._run.has_ended_within(LOOK_S):
            assert time.monotonic() - self._begin < DEADLINE_S, self._run.errors
            if detected is None and self._is_closed():
                detected = time.monotonic() - self._begin
        ended = time.monotonic() - self._begin
        detected = ended if detected is None else detected
        lines = [line for line in self._run.errors.splitlines() if not line.startswith('[')]
        print(f'detected after {detected:.2f} s, ended after {ended:.2f} s: {lines}')
        assert len(lines) == 1, self._run.errors
        assert detected < within_s + SETTLE_S
        assert ended < within_s + SETTLE_S + END_S
        self.assert_nothing_left()
        return Ended(self._run.exit_code(), lines[0], detected, ended)

    def assert_nothing_left(self) -> None:
        """Fail if a process still runs, or shared memory of one of them still exists."""
        assert [pid for pid in self.pids if is_alive(pid)] == []
        assert [path for path in sorted(self._segments) if Path(path).exists()] == []

    def _is_closed(self) -> bool:
        """Return whether the recorder has ended its file."""
        if self._file is None or not self._file.exists():
            return False
        with self._file.open('rb') as file:
            size = file.seek(0, 2)
            file.seek(max(0, size - len(MCAP0_MAGIC)))
            return size > len(MCAP0_MAGIC) and file.read() == MCAP0_MAGIC


def shared_memory(pid: int) -> set[str]:
    """Return the middleware's shared memory that a process has, as paths."""
    return set(_SHARED_MEMORY.findall(Path(f'/proc/{pid}/maps').read_text()))


def wait_for_tick_0(bag: Path, run: Started) -> None:
    """Wait until the bag exists: all participants have answered the hello."""
    wait_for(lambda: (bag / 'metadata.yaml').exists() or not run.is_running(), 'tick 0')
    assert run.is_running(), run.errors


def wait_for_chunk(bag: Path, run: Started) -> None:
    """Wait until the recorder has written a chunk, the whole of it."""
    wait_for_tick_0(bag, run)
    before = Bag(bag).n_messages
    wait_for(lambda: Bag(bag).n_messages > before or not run.is_running(), 'a chunk')
    assert run.is_running(), run.errors


def assert_replays(bag: Path, is_whole: bool = True) -> int:
    """Return the last tick of a bag that opens, has no gap, and replays."""
    read = Bag(bag)
    assert read.is_whole == is_whole
    sequences = [tick.sequence for tick in read.ticks()]
    assert sequences == list(range(len(sequences)))
    assert main(['replay', str(bag)]) == 0
    return sequences[-1]


def assert_last_second_lost_at_most(bag: Path, reached_ns: int) -> None:
    """Fail unless a bag cut short ends at most a second before the time reached."""
    end = Bag(bag).end_ns
    assert end is not None and end >= reached_ns - ONE_SECOND_NS


class ClockListener:
    """The progress of a run, as seen on `/clock`."""

    def __init__(self, observer: Node) -> None:
        self._subscription = observer.create_subscription(
            Clock, '/clock', lambda message: None, 1)
        self._latest_ns = 0

    def latest_ns(self) -> int:
        """Return the newest instant that has arrived; 0: none."""
        while (taken := self._subscription.handle.take_message(Clock, False)) is not None:
            clock = taken[0].clock
            self._latest_ns = clock.sec * ONE_SECOND_NS + clock.nanosec
        return self._latest_ns


def with_timeout(path: Path, seconds: float) -> Path:
    """Return the rig's configuration with another tick timeout."""
    text = RIG.read_text()
    assert 'tick_timeout_s: 5.0' in text
    path.write_text(text.replace('tick_timeout_s: 5.0', f'tick_timeout_s: {seconds}'))
    return path
