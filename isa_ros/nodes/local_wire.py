"""
The private wire between processes of one host: a Unix socket to each participant.

It carries the same bytes as the topics of the wire, for half the time of a tick: the kernel
wakes the receiver directly, without a thread of the middleware in between. Its name is abstract
and holds the run's id, so that only a process of the same network namespace can reach it and
nothing is left behind. A run whose participants are not all on its host does without.
"""

from collections.abc import Mapping
import select
import socket
import struct
import sys

LARGEST = 65536
"""Bytes of the largest message; a larger one travels as a topic."""

_IDENTITY = 64  # bytes at most
_TIME = struct.Struct('@ll')  # struct timeval


def is_possible() -> bool:
    """Return whether this host has abstract socket names: Linux has."""
    return sys.platform == 'linux'


def _name(run_id: int) -> str:
    return f'\0isa_ros/run/{run_id:016x}'


def _socket() -> socket.socket:
    return socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)


class LocalWire:
    """A participant's end."""

    def __init__(self, end: socket.socket) -> None:
        self._socket = end
        self.is_open = True

    @staticmethod
    def to_run(run_id: int, identity: bytes, slice_s: float) -> 'LocalWire | None':
        """Connect to the coordinator of a run and say who this is; None: it is elsewhere."""
        if not is_possible():
            return None
        end = _socket()
        try:
            end.connect(_name(run_id))
            end.send(identity)
        except OSError:
            end.close()
            return None
        # The kernel's own limit, for which Python need not poll before it reads.
        seconds, part = divmod(slice_s, 1.0)
        end.setsockopt(
            socket.SOL_SOCKET, socket.SO_RCVTIMEO, _TIME.pack(int(seconds), int(part * 1e6)))
        return LocalWire(end)

    def wait(self) -> bytes | None:
        """Return the next message, or None if none arrives within the slice or ever."""
        try:
            data = self._socket.recv(LARGEST)
        except BlockingIOError:
            return None
        except OSError:
            data = b''
        if not data:
            self.close()
            return None
        return data

    def send(self, message: bytes) -> bool:
        """Send; return whether it was possible."""
        if not self.is_open or len(message) > LARGEST:
            return False
        try:
            self._socket.send(message)
        except OSError:
            self.close()
            return False
        return True

    def close(self) -> None:
        """Hang up."""
        self.is_open = False
        self._socket.close()


class LocalWires:
    """The coordinator's ends, one to each participant of a run."""

    def __init__(self) -> None:
        self._listening: socket.socket | None = None
        self._ends: dict[int, socket.socket] = {}  # by file descriptor
        self._ready: list[int] = []
        if is_possible():
            self._epoll = select.epoll()

    def listen(self, run_id: int) -> None:
        """Let the participants of a run connect."""
        if is_possible():
            self._listening = _socket()
            self._listening.bind(_name(run_id))
            self._listening.listen(socket.SOMAXCONN)
            self._listening.setblocking(False)

    def connect(self, identities: Mapping[int, bytes]) -> bool:
        """
        Take the calls of the participants; return whether all of them are on this host.

        They have called before they say over the topics that they are ready. Nobody can call
        any more.
        """
        if self._listening is None:
            return False
        missing = set(identities.values())
        while missing:
            try:
                end, _ = self._listening.accept()
            except OSError:
                break
            end.setblocking(False)
            identity = _first_message(end)
            if identity not in missing:
                end.close()
                continue
            missing.remove(identity)
            self._ends[end.fileno()] = end
            self._epoll.register(end.fileno(), select.EPOLLIN)
        self._listening.close()
        if missing:
            self.close()
        return not missing

    def send(self, message: bytes) -> bool:
        """
        Send to all; return whether it was possible.

        One that does not read or is gone misses it, which shows in its answer.
        """
        if len(message) > LARGEST:
            return False
        for end in self._ends.values():
            try:
                end.send(message)
            except OSError:
                pass
        return True

    def wait(self, timeout_s: float) -> bytes | None:
        """Return the next message, or None if none arrives within ``timeout_s``."""
        if not self._ready:
            self._ready = [number for number, _ in self._epoll.poll(timeout_s)]
        while self._ready:
            number = self._ready.pop()
            try:
                data = self._ends[number].recv(LARGEST)
            except OSError:
                data = b''
            if data:
                return data
            self._epoll.unregister(number)  # hung up: its process has ended
            self._ends.pop(number).close()
        return None

    def close(self) -> None:
        """Hang up."""
        if self._listening is not None:
            self._listening.close()
        for number, end in self._ends.items():
            self._epoll.unregister(number)
            end.close()
        self._ends.clear()
        self._ready.clear()


def _first_message(end: socket.socket) -> bytes:
    try:
        return end.recv(_IDENTITY)
    except OSError:
        return b''
