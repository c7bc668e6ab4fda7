"""ZeroMQ with ipc sockets: PUB/SUB for steps, PUSH/PULL for answers."""

from pathlib import Path

import zmq

_STEPS, _ANSWERS = 'steps', 'answers'


class SocketEnd:
    """A socket to send on and one to receive from."""

    def __init__(self, context: zmq.Context, out: zmq.Socket, into: zmq.Socket) -> None:
        self._context = context
        self._out = out
        self._in = into
        self._timeout_ms = -1

    def send(self, message: bytes) -> None:
        """Send to all connected sockets."""
        self._out.send(message)

    def receive(self, timeout_s: float) -> bytes | None:
        """Return the next message, or None after the timeout."""
        timeout_ms = int(timeout_s * 1e3)
        if timeout_ms != self._timeout_ms:
            self._in.setsockopt(zmq.RCVTIMEO, timeout_ms)
            self._timeout_ms = timeout_ms
        try:
            message: bytes = self._in.recv()
        except zmq.Again:
            return None
        return message

    def close(self) -> None:
        """Close both sockets after queued messages have been sent."""
        self._context.destroy(linger=1000)


def coordinator_end(directory: Path, n_workers: int) -> SocketEnd:
    """Publish steps and pull answers; the sockets are in ``directory``."""
    context = zmq.Context()
    out, into = context.socket(zmq.PUB), context.socket(zmq.PULL)
    out.bind(_address(directory, _STEPS))
    into.bind(_address(directory, _ANSWERS))
    return SocketEnd(context, out, into)


def worker_end(directory: Path, index: int) -> SocketEnd:
    """Subscribe to the steps and push answers."""
    context = zmq.Context()
    out, into = context.socket(zmq.PUSH), context.socket(zmq.SUB)
    into.subscribe(b'')
    into.connect(_address(directory, _STEPS))
    out.connect(_address(directory, _ANSWERS))
    return SocketEnd(context, out, into)


def _address(directory: Path, name: str) -> str:
    return f'ipc://{directory / name}'
