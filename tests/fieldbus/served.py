"""`isa bus` as a child process of a test, in the network namespace of the test's master."""

from collections.abc import Iterator
from contextlib import contextmanager
import os
import random
import signal
import subprocess
import sys

READY, END_S = 'wait for a master', 60.0


class Served:
    """A running `isa bus`; its end is known after `end`."""

    def __init__(self, process: 'subprocess.Popen[str]') -> None:
        self._process = process
        self.lines: list[str] = []
        """What it printed for the user."""
        self.code: int | None = None

    def wait(self) -> None:
        """Wait until it is ready for a master."""
        assert self._process.stderr is not None
        for line in self._process.stderr:
            self.lines.append(line.strip())
            if READY in line:
                return
        raise SystemExit(self.lines[-1] if self.lines else 'isa bus has ended')

    def interrupt(self) -> None:
        """End it as Ctrl-C does."""
        self._process.send_signal(signal.SIGINT)

    def end(self) -> None:
        """Wait for its end."""
        self.lines += self._process.communicate(timeout=END_S)[1].splitlines()
        self.code = self._process.returncode


@contextmanager
def served(*arguments: str, has_ros: bool = False) -> Iterator[Served]:
    """Start `isa bus`; after an error of the master interrupt it."""
    process = subprocess.Popen(
        [sys.executable, '-m', 'isa_ros', 'bus', *arguments, *(() if has_ros else ('--no-ros',))],
        env={**os.environ, 'ROS_DOMAIN_ID': '1'},   # the namespace has no other node
        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    own = Served(process)
    try:
        own.wait()
        yield own
        own.end()
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
            process.communicate(timeout=END_S)


def stalls(seed: int, n_cycles: int, count: int, longest: float) -> dict[int, float]:
    """Return random pauses in s by cycle."""
    rng = random.Random(seed)
    return {cycle: rng.uniform(0.0, longest) for cycle in rng.sample(range(n_cycles), count)}
