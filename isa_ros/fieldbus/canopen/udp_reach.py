"""
Who can reach a bus of python-can's interface ``udp_multicast``.

It binds its socket to all addresses, and joins the group on the interface that the route to the
group takes. Where an interface other than the loopback has an address, other hosts can send
frames, and CAN has no authentication; so that has to be asked for.
"""

from collections.abc import Iterator
import fcntl
import ipaddress
from pathlib import Path
import socket
import struct

from isa_ros.errors import ConfigError

UDP_MULTICAST = 'udp_multicast'
_PORT = 43113           # of python-can, where none is given
_GET_FLAGS, _GET_ADDRESS = 0x8913, 0x8915   # SIOCGIFFLAGS, SIOCGIFADDR of Linux
_REQUEST = struct.Struct('16s24x')          # struct ifreq
_FLAGS, _ADDRESS = struct.Struct('16xH'), slice(20, 24)
_IS_UP, _IS_LOOPBACK = 0x1, 0x8
_IPV6_ADDRESSES = Path('/proc/net/if_inet6')
_LOOPBACK = 'lo'


def reach_of(interface: str, channel: str, allow_network: bool) -> str:
    """
    Return a line that says what is bound, '' for other interfaces and what is no group.

    Raises
    ------
    ConfigError
        Other hosts can reach it and ``allow_network`` is False.

    """
    if interface != UDP_MULTICAST:
        return ''
    try:
        group = ipaddress.ip_address(channel)
    except ValueError:
        return ''   # opening it has the reason
    is_ipv4 = group.version == 4
    bound = f'UDP {"0.0.0.0" if is_ipv4 else "[::]"}:{_PORT}, group {channel}'
    exposed = sorted(set(_ipv4_interfaces() if is_ipv4 else _ipv6_interfaces()))
    if not exposed:
        return f'{interface} binds {bound}; no interface but the loopback has an address'
    if not allow_network:
        raise ConfigError(
            f'interface = {interface} binds {bound}: whoever reaches {", ".join(exposed)} could '
            'command the actuators; run it in a network namespace (unshare -rn, see '
            'docs/canopen.md), or with --allow-network')
    return f'{interface} binds {bound}: whoever reaches {", ".join(exposed)} can send frames'


def _ipv4_interfaces() -> Iterator[str]:
    """Yield the interfaces that are up and have an address, without the loopback."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        for _, name in socket.if_nameindex():
            request = _REQUEST.pack(name.encode())
            try:
                flags, = _FLAGS.unpack_from(fcntl.ioctl(any_socket, _GET_FLAGS, request))
                address = fcntl.ioctl(any_socket, _GET_ADDRESS, request)[_ADDRESS]
            except OSError:     # it has none, or is gone
                continue
            if flags & _IS_UP and not flags & _IS_LOOPBACK and any(address):
                yield name


def _ipv6_interfaces() -> Iterator[str]:
    if _IPV6_ADDRESSES.exists():
        for line in _IPV6_ADDRESSES.read_text().splitlines():
            name = line.split()[-1]
            if name != _LOOPBACK:
                yield name
