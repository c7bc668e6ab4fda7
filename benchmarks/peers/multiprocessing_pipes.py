"""The floor of the peers: pipes of multiprocessing, on Unix sockets."""

from multiprocessing.connection import Client, Connection, Listener, wait
from pathlib import Path

_ADDRESS = 'pipes'


class CoordinatorPipes:
    """A pipe to every worker."""

    def __init__(self, directory: Path, n_workers: int) -> None:
        self._listener = Listener(str(directory / _ADDRESS), 'AF_UNIX', backlog=n_workers)
        self._n_workers = n_workers
        self._pipes: list[Connection] = []

    def send(self, message: bytes) -> None:
        """Write to every pipe; accept the workers the first time."""
        while len(self._pipes) < self._n_workers:
            self._pipes.append(self._listener.accept())
        for pipe in self._pipes:
            pipe.send_bytes(message)

    def receive(self, timeout_s: float) -> bytes | None:
        """Read from one of the pipes that have a message."""
        for pipe in wait(self._pipes, timeout_s):
            assert isinstance(pipe, Connection)
            return pipe.recv_bytes()
        return None

    def close(self) -> None:
        """Close all pipes."""
        for pipe in self._pipes:
            pipe.close()
        self._listener.close()


class WorkerPipe:
    """The pipe of a worker."""

    def __init__(self, directory: Path) -> None:
        self._pipe = Client(str(directory / _ADDRESS), 'AF_UNIX')

    def send(self, message: bytes) -> None:
        """Write to the pipe."""
        self._pipe.send_bytes(message)

    def receive(self, timeout_s: float) -> bytes | None:
        """Read a message, or return None after the timeout."""
        return self._pipe.recv_bytes() if self._pipe.poll(timeout_s) else None

    def close(self) -> None:
        """Close the pipe."""
        self._pipe.close()


def coordinator_end(directory: Path, n_workers: int) -> CoordinatorPipes:
    """Listen on a socket in ``directory``."""
    return CoordinatorPipes(directory, n_workers)


def worker_end(directory: Path, index: int) -> WorkerPipe:
    """Connect to the coordinator."""
    return WorkerPipe(directory)
