"""A raw socket on a network interface, for EtherCAT frames only."""

import fcntl
import socket
import struct

from isa_ros.errors import ConfigError
from isa_ros.fieldbus.ethercat.datagrams import ETHERTYPE

_LONGEST_NAME = 15
_GET_FLAGS, _REQUEST = 0x8913, struct.Struct('16sH14x')
"""SIOCGIFFLAGS of Linux and its `struct ifreq`."""
_IS_UP, _IS_LOOPBACK = 0x1, 0x8
_PACKET, _IGNORE_OUTGOING = 263, 23
"""SOL_PACKET and PACKET_IGNORE_OUTGOING of Linux."""


def open_interface(name: str) -> socket.socket:
    """
    Return a raw socket bound to a network interface.

    Raises
    ------
    ConfigError
        There is no such interface, it is down or the loopback, or raw sockets are not permitted.

    """
    if not hasattr(socket, 'AF_PACKET'):
        raise ConfigError(
            f'interface {name}: EtherCAT needs raw sockets of Linux, which this system lacks')
    present = [one for _, one in socket.if_nameindex()]
    if not 0 < len(name) <= _LONGEST_NAME or name not in present:
        raise ConfigError(f"interface '{name}' does not exist, must be one of "
                          f"{', '.join(present)}; a pair of virtual ones: "
                          'ip link add ecs type veth peer name ecm')
    flags = _flags(name)
    if flags & _IS_LOOPBACK:
        raise ConfigError(f'interface {name} is the loopback, must be an Ethernet interface')
    if not flags & _IS_UP:
        raise ConfigError(f'interface {name} is down, must be up: ip link set {name} up')
    try:
        opened = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ETHERTYPE))
    except PermissionError:
        raise ConfigError(
            f'interface {name}: no permission for raw sockets, needs CAP_NET_RAW: run in a '
            'namespace of your own (unshare -rn) or as root') from None
    opened.bind((name, 0))
    _ignore_outgoing(opened)
    return opened


def _flags(name: str) -> int:
    """Return the flags of an interface."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        answer = fcntl.ioctl(any_socket, _GET_FLAGS, _REQUEST.pack(name.encode(), 0))
    return int(_REQUEST.unpack(answer)[1])


def _ignore_outgoing(opened: socket.socket) -> None:
    """Leave out frames that this host sends on the interface; Linux before 4.20 cannot."""
    try:
        opened.setsockopt(_PACKET, _IGNORE_OUTGOING, 1)
    except OSError:
        pass
