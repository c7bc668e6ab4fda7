"""
The door to a CAN bus: any interface of python-can, opened, read and written in one thread.

Frames are those of classical CAN with identifiers of 11 bits. Error, extended and FD frames are
none of CANopen's here; they are counted and ignored, and so is what python-can cannot decode.
"""

from collections.abc import Callable, Mapping
import errno
import logging
import math
import time
from typing import NamedTuple, TYPE_CHECKING

from isa_ros.errors import ConfigError, RunError

if TYPE_CHECKING:
    import can

_INSTALL = "pip install -e '.[canopen]'"
_NEEDED = {'serial module': "pip install 'python-can[serial]'", 'msgpack': _INSTALL}
"""What interfaces need besides python-can, by what its errors say."""
_SPURIOUS = (ValueError, IndexError)    # of python-can: a frame that it cannot decode


class Frame(NamedTuple):
    """A data or remote frame."""

    identifier: int
    data: bytes
    is_remote: bool = False
    """Whether it asks for data."""


IGNORED = Frame(-1, b'')
"""Stands for a received frame of another kind."""
MOST_FRAMES = 1000     # handled beyond the time of a call of `CanPort.serve`


class CanPort:
    """One participant of a CAN bus."""

    def __init__(self, interface: str, channel: str, bitrate: int,
                 options: Mapping[str, object] | None = None) -> None:
        """
        Open the bus.

        ``options`` are further keywords of the interface of python-can.

        Raises
        ------
        ConfigError
            python-can or what the interface needs is not installed, there is no such interface,
            or the bus cannot be opened.

        """
        # Its warnings would be a second line beside an error of ours.
        logging.getLogger('can').addHandler(logging.NullHandler())
        try:
            import can
        except ImportError as error:
            raise ConfigError(
                f'CANopen needs python-can: {error}; install it by {_INSTALL}') from error
        self.ignored = 0
        """Frames of other kinds, or undecodable, since the start."""
        self.unsent = 0
        """Frames that the bus did not take."""
        self._can = can
        self._bus = _opened(interface, channel, bitrate, options or {})
        self._name = f'{interface} {channel}'

    def receive(self, timeout: float) -> Frame | None:
        """
        Return the next frame, or None if none arrives within ``timeout`` seconds.

        Raises
        ------
        RunError
            The bus is lost.

        """
        try:
            message = self._bus.recv(max(0.0, timeout))
        except _SPURIOUS:
            return self._ignored()
        except (self._can.CanError, OSError) as error:
            if isinstance(error, OSError) or isinstance(error.__cause__, OSError):
                raise RunError(f'CAN bus {self._name} is lost: {error}') from error
            return self._ignored()  # python-can could not decode it
        if message is None:
            return None
        if message.is_error_frame or message.is_extended_id or message.is_fd:
            return self._ignored()
        return Frame(message.arbitration_id, bytes(message.data), message.is_remote_frame)

    def serve(self, timeout: float, handle: Callable[[Frame], bool],
              due: Callable[[float], float] = lambda now: math.inf) -> bool:
        """
        Handle frames for ``timeout`` seconds, or until one begins a tick: then True.

        0: those that are there. ``due`` is called with the wall time before each wait, and returns
        the one at which it is to be called again, s. Raises as `receive`.
        """
        now = monotonic()
        deadline, handled = now + timeout, 0
        while handled < MOST_FRAMES or now < deadline:
            frame = self.receive(min(deadline, due(now)) - now)
            now = monotonic()
            if frame is None:
                if now >= deadline:
                    return False
            elif handle(frame):
                return True
            handled += 1
        return False

    def send(self, identifier: int, data: bytes) -> None:
        """Send a frame; one that the bus does not take (full, off) is counted and dropped."""
        message = self._can.Message(
            arbitration_id=identifier, data=data, is_extended_id=False)
        try:
            self._bus.send(message)
        except (self._can.CanError, OSError):
            self.unsent += 1

    def close(self) -> None:
        """Leave the bus."""
        self._bus.shutdown()

    def _ignored(self) -> Frame:
        self.ignored += 1
        return IGNORED


def _opened(interface: str, channel: str, bitrate: int,
            options: Mapping[str, object]) -> 'can.BusABC':
    import can
    place = f'interface = {interface}, channel = {channel}'
    if interface not in can.VALID_INTERFACES:
        raise ConfigError(
            f'{place}: no interface of python-can; one of '
            f'{", ".join(sorted(can.VALID_INTERFACES))}')
    try:
        return can.Bus(channel, interface, None, True, bitrate=bitrate, **options)
    except (can.CanError, OSError, ValueError, TypeError, ImportError) as error:
        reason = error.__cause__ if isinstance(error.__cause__, (OSError, ImportError)) else error
        raise ConfigError(f'{place}: the bus cannot be opened: {reason}{_hint(reason)}') from error


def _hint(reason: BaseException) -> str:
    for module, command in _NEEDED.items():
        if module in str(reason):
            return f'; install it by {command}'
    if isinstance(reason, OSError) and reason.errno == errno.EAFNOSUPPORT:
        return '; this kernel has no SocketCAN, but udp_multicast needs none'
    return ''


def monotonic() -> float:
    """Return wall time (s) for heartbeats and timeouts, which no sample depends on."""
    return time.monotonic()
