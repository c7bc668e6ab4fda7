"""EtherCAT as a `Line`: a ring of slaves on a raw socket."""

from collections.abc import Callable, Sequence
import errno
import os
import select
import socket
import struct
import time

from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError, RunError
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.ethercat.datagrams import Datagrams
from isa_ros.fieldbus.ethercat.interface import open_interface
from isa_ros.fieldbus.ethercat.ring import Ring
from isa_ros.fieldbus.line import Line

_BUFFER = 2048
"""Larger than the longest frame of EtherCAT, 1518 bytes."""
_TIME = struct.Struct('@ll')
_MICROSECONDS = 1_000_000
_COARSE_S = 0.05
"""A socket's own timeout ends with a tick of the kernel's timer, up to 10 ms late."""


def ethercat_line(
        devices: Sequence[BusDevice], interface: str, step_ns: int, order: str = '') -> Line:
    """
    Return the slaves of devices on a network interface; a tick takes ``step_ns``.

    ``order`` has their names, with commas, as the cables connect them; '': as they are given.

    Raises
    ------
    ConfigError
        The interface cannot be used, or the order has not each name once.

    """
    return EthercatLine(
        Ring(cabled(devices, order), step_ns), open_interface(interface), interface)


def refuse_unusable(
        devices: Sequence[BusDevice], interface: str, step_ns: int, order: str = '') -> None:
    """Refuse an interface that cannot be used; parameters and errors as of `ethercat_line`."""
    cabled(devices, order)
    open_interface(interface).close()


def cabled(devices: Sequence[BusDevice], order: str) -> list[BusDevice]:
    """Return devices in the order of their cables; all as of `ethercat_line`."""
    by_name = {device.name: device for device in devices}
    names = order.split(',') if order else list(by_name)
    if sorted(names) != sorted(by_name):
        raise ConfigError(f"--order {order}: must have each of {', '.join(by_name)} once")
    return [by_name[name] for name in names]


class EthercatLine:
    """Answers the frames that arrive at an interface."""

    def __init__(self, ring: Ring, opened: socket.socket, interface: str) -> None:
        self.ring = ring
        self._socket, self._interface = opened, interface
        self._frame = bytearray(_BUFFER)
        self._view = memoryview(self._frame)
        self._held: tuple[int, Datagrams] | None = None
        self._timeout = -1.0

    def serve(self, timeout: float) -> bool:
        """Answer frames for ``timeout`` seconds, or until a cycle is a tick: then True."""
        deadline = time.monotonic() + timeout
        while self._held is not None or self._receive(timeout):
            if self._held is not None and self._answer():
                return True
            if timeout > 0.0:
                timeout = max(0.0, deadline - time.monotonic())
        return False

    def _answer(self) -> bool:
        """Answer the frame that is held; return whether a tick has begun."""
        assert self._held is not None
        size, taken = self._held
        if self.ring.is_next_cycle(taken) and self.ring.end_cycle():
            return True  # the frame belongs to the cycle after this tick
        self._held = None
        self.ring.process(self._frame, taken)
        if self.ring.reached:   # else the cable of the master is pulled
            self._send(size)
        return self.ring.is_complete and self.ring.end_cycle()

    def _receive(self, timeout: float) -> bool:
        """Receive a frame, and hold it if it is EtherCAT; return False if none arrives in time."""
        try:
            if timeout >= _COARSE_S:
                self._set_timeout(timeout)
            elif timeout > 0.0:
                select.select([self._socket], (), (), timeout)
            size = self._socket.recv_into(
                self._frame, 0, 0 if timeout >= _COARSE_S else socket.MSG_DONTWAIT)
        except BlockingIOError:
            return False
        except OSError as error:
            self._note_failure(error)
            return False
        taken = self.ring.take(self._frame, size)
        if taken is not None:
            self._held = size, taken
        return True

    def _set_timeout(self, timeout: float) -> None:
        """Let the kernel end a wait, which takes one system call a frame instead of two."""
        if timeout == self._timeout:
            return
        self._timeout = timeout
        microseconds = max(1, round(timeout * _MICROSECONDS))
        value = _TIME.pack(*divmod(microseconds, _MICROSECONDS))
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, value)

    def _send(self, size: int) -> None:
        """Return a frame to the master; one that the interface refuses is lost."""
        try:
            self._socket.send(self._view[:size])
        except OSError as error:
            self._note_failure(error)

    def _note_failure(self, error: OSError) -> None:
        """Count a lost link; a frame that finds no room is lost."""
        if error.errno == errno.ENOBUFS:
            return
        try:
            socket.if_nametoindex(self._interface)
        except OSError:
            raise RunError(f'interface {self._interface} was removed during the run') from None
        if error.errno != errno.ENETDOWN:
            raise RunError(
                f'interface {self._interface}: {os.strerror(error.errno or 0)}') from None
        self.ring.lose_link()

    def update(self) -> None:
        """Take the devices' new samples as inputs; simulated time has advanced by one tick."""
        self.ring.update()

    def set_port(self, device: str, fault: str, is_on: bool) -> None:
        """Begin or end a fault of a device's connection."""
        self.ring.set_port(device, fault, is_on)

    def keep_host_time(self, now_ns: Callable[[], int]) -> None:
        """Let the distributed clocks run with host time, ns."""
        self.ring.clock.run_with(now_ns)

    def until_sync(self) -> float:
        """Return the time until SYNC0, s."""
        return self.ring.until_sync_ns() / NS_PER_SECOND

    def miss(self) -> None:
        """Let the watchdog of every slave in operation expire."""
        self.ring.miss()

    def close(self) -> None:
        """Leave the bus."""
        self._socket.close()
