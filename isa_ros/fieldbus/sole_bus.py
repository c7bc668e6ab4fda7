"""
One `isa bus` on an interface or channel: two would both answer the master.

An abstract socket name is held, which belongs to the network namespace, as network interfaces and
CAN channels do, and which is released with the process, however it ends. Whoever holds it is
named. A serial line is refused by the line itself.
"""

from collections.abc import Iterator
from contextlib import contextmanager
import errno
import hashlib
import socket
import struct
import sys

from isa_ros.errors import ConfigError
from isa_ros.fieldbus.request import BUSES, BusRequest

_CREDENTIALS = struct.Struct('@iII')  # struct ucred of Linux: process, user, group


@contextmanager
def sole_bus(request: BusRequest) -> Iterator[None]:
    """
    Hold the place of a request within the context.

    Raises
    ------
    ConfigError
        Another process holds it.

    """
    medium = BUSES[request.bus].medium
    if not medium or sys.platform != 'linux':
        yield
        return
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as held:
        address = _address(medium, request.place)
        try:
            held.bind(address)
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                raise
            raise ConfigError(
                f'{request.bus} on {request.place}: {_holder(address)} serves it already, and a '
                'master would be answered twice; end that run or take another one') from None
        held.listen()   # nothing is accepted: who connects reads process and user
        yield


def _address(medium: str, place: str) -> str:
    """Return an abstract name, which is at most 107 bytes long, of a place of any length."""
    return f'\0isa_ros/bus/{medium}/{hashlib.sha256(place.encode()).hexdigest()[:32]}'


def _holder(address: str) -> str:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as end:
        end.setblocking(False)
        try:
            end.connect(address)
            process, user, _ = _CREDENTIALS.unpack(
                end.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size))
        except OSError:
            return 'another isa bus'
    return f'another isa bus (process {process} of user {user})'
