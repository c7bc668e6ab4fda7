"""
The private wire on one host: a Unix socket to each participant.

The bytes are those of the wire's topics, but a tick takes half the time: the kernel wakes the
receiver directly, without a thread of the middleware. The socket's name is abstract and contains
the run's id: only processes of the same network namespace can connect, and no file remains. If
the sockets fail for any reason, the run continues on the topics. The first message of the
coordinator brings the file of the run's board (`isa_ros.run.wire.board`), where ticks take less
than by socket.
"""

from collections.abc import Callable, Mapping
import os
import select
import socket
import struct
import sys

from isa_ros.nodes.middleware.handles import has_handles
from isa_ros.nodes.middleware.mailboxes import SLICE_S
from isa_ros.run.wire.board import board_of, no_board

LARGEST = 65536
"""Bytes of the largest message."""

_IDENTITY_BYTES = 64  # largest size
_WELCOME = b'welcome'
_MOST_REJECTED = 1000  # connections; with more of them a run uses the topics
_TIME = struct.Struct('@ll')  # struct timeval
_CREDENTIALS = struct.Struct('@iII')  # struct ucred: process, user, group


def is_possible() -> bool:
    """
    Return whether sockets can be used: only Linux has abstract names.

    Without rclpy's handles a participant receives setpoints only while it waits for a topic.
    """
    return sys.platform == 'linux' and has_handles()


def _name(run_id: int) -> str:
    return f'\0isa_ros/run/{run_id:016x}'


def _socket() -> socket.socket:
    """Return a non-blocking socket, also if the process has set a default timeout."""
    made = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    made.setblocking(False)
    return made


def _wait_by_itself(end: socket.socket, slice_s: float) -> None:
    """Let the kernel end a wait after ``slice_s``: nobody need poll before it reads."""
    end.setblocking(True)
    seconds, part = divmod(slice_s, 1.0)
    end.setsockopt(
        socket.SOL_SOCKET, socket.SO_RCVTIMEO, _TIME.pack(int(seconds), int(part * 1e6)))


class LocalWire:
    """A participant's end of the socket."""

    def __init__(self, end: socket.socket) -> None:
        self._socket = end
        self.is_open = True
        self.ring: Callable[[], object] = lambda: None
        """Wakes a coordinator that waits at the board, after a message and at the end."""
        self.board = no_board()
        """That of the run, once it has welcomed."""

    @staticmethod
    def to_run(run_id: int, identity: bytes, slice_s: float) -> 'LocalWire | None':
        """Connect to the coordinator of a run and send ``identity``; None: not possible."""
        if not is_possible():
            return None
        end = _socket()
        try:
            end.connect(_name(run_id))
            end.send(identity)
            _wait_by_itself(end, slice_s)
        except OSError:
            end.close()
            return None
        return LocalWire(end)

    @property
    def number(self) -> int:
        """Return the file descriptor; below 0: closed."""
        return self._socket.fileno()

    def welcomed(self) -> None:
        """Receive the first message, with the board of the run if it has one."""
        files: list[int] = []
        try:
            data, files, _, _ = socket.recv_fds(
                self._socket, len(_WELCOME), 1, socket.MSG_DONTWAIT)
            if files:
                self.board = board_of(files[0], LARGEST)
        except OSError:
            data = b''
        for file in files:
            os.close(file)
        if data != _WELCOME:
            self.close()

    def wait(self) -> bytes | None:
        """Return the next message; None after the timeout, or if the socket is closed."""
        return self._received(0)

    def take(self) -> bytes | None:
        """Return the next message if there is one."""
        return self._received(socket.MSG_DONTWAIT)

    def _received(self, flags: int) -> bytes | None:
        try:
            data = self._socket.recv(LARGEST, flags)
        except BlockingIOError:
            return None
        except OSError:
            data = b''
        if not data:
            self.close()
            return None
        return data

    def send(self, message: bytes) -> bool:
        """Send a message; return whether it was sent."""
        if not self.is_open or len(message) > LARGEST:
            return False
        try:
            self._socket.send(message)
        except OSError:
            self.close()
            return False
        self.ring()
        return True

    def close(self) -> None:
        """Close the socket; the kernel informs the coordinator."""
        self.is_open = False
        self._socket.close()
        self.ring()


class LocalWires:
    """The coordinator's sockets, one to each participant of a run: to all of them, or none."""

    def __init__(self) -> None:
        self._listening: socket.socket | None = None
        self._ends: dict[int, socket.socket] = {}  # by file descriptor
        self._numbers: dict[int, int] = {}  # file descriptor by participant
        self._ready: list[int] = []
        self.ring: Callable[[], object] = lambda: None
        """Wakes participants that wait at the board, after a message and at the end."""
        if is_possible():
            self._epoll = select.epoll()

    @property
    def is_open(self) -> bool:
        """Return whether every participant is connected."""
        return bool(self._ends)

    def listen(self, run_id: int) -> None:
        """Listen for connections of the participants of a run."""
        if not is_possible():
            return
        self._listening = _socket()
        try:
            self._listening.bind(_name(run_id))
            self._listening.listen(socket.SOMAXCONN)
        except OSError:
            self.close()

    def connect(self, identities: Mapping[int, bytes]) -> bool:
        """
        Accept the pending connections; return whether every participant is connected.

        Participants connect before they answer a hello on the topics. Later connections are
        refused.
        """
        missing = {identity: participant for participant, identity in identities.items()}
        try:
            for _ in range(len(missing) + _MOST_REJECTED):
                if self._listening is None or not missing:
                    break
                end, _ = self._listening.accept()
                _wait_by_itself(end, SLICE_S)
                identity = _first_message(end)
                if identity not in missing or not _is_of_this_user(end):
                    end.close()
                    continue
                self._numbers[missing.pop(identity)] = end.fileno()
                self._ends[end.fileno()] = end
                self._epoll.register(end.fileno(), select.EPOLLIN)
        except OSError:
            pass  # no more pending connections
        self._stop_listening()
        if missing:
            self.close()
        return self.is_open

    def welcome(self, file: int | None) -> None:
        """Send the first message to all, with the file of the board; None: the run has none."""
        try:
            for end in self._ends.values():
                socket.send_fds(end, [_WELCOME], [] if file is None else [file])
        except OSError:
            self.close()

    def numbers(self) -> list[int]:
        """Return the file descriptors in the order of the participants; they wait `SLICE_S`."""
        return [self._numbers[participant] for participant in sorted(self._numbers)]

    def send(self, message: bytes) -> bool:
        """Send to all and return True; on failure close all and return False."""
        try:
            if len(message) <= LARGEST:
                for end in self._ends.values():
                    end.send(message, socket.MSG_DONTWAIT)
                self.ring()
                return self.is_open
        except OSError:
            pass
        self.close()
        return False

    def wait(self, timeout_s: float) -> bytes | None:
        """
        Return the next message, or None if none arrives within ``timeout_s``.

        If a participant has closed its end, all are closed.
        """
        if not self._ready:
            self._ready = [number for number, _ in self._epoll.poll(timeout_s)]
        while self._ready:
            try:
                data = self._ends[self._ready.pop()].recv(LARGEST, socket.MSG_DONTWAIT)
            except BlockingIOError:
                continue
            except OSError:
                data = b''
            if data:
                return data
            self.close()
        return None

    def close(self) -> None:
        """Close all ends."""
        self._stop_listening()
        for number, end in self._ends.items():
            self._epoll.unregister(number)
            end.close()
        self._ends.clear()
        self._numbers.clear()
        self._ready.clear()
        self.ring()

    def _stop_listening(self) -> None:
        if self._listening is not None:
            self._listening.close()
            self._listening = None


def _first_message(end: socket.socket) -> bytes:
    try:
        return end.recv(_IDENTITY_BYTES, socket.MSG_DONTWAIT)
    except OSError:
        return b''


def _is_of_this_user(end: socket.socket) -> bool:
    credentials = end.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    _, user, _ = _CREDENTIALS.unpack(credentials)
    return bool(user == os.geteuid())
