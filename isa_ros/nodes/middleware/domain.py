"""
One coordinator per ROS domain and host.

The ROS graph shows another coordinator only after its discovery, 0.1 s to more than a second
after the start. On one host, to which discovery is limited by default, an abstract socket name
detects it at once: the name belongs to the network namespace and is released with the process
that holds it. If other hosts are discovered too, a run in one process waits for the graph; a run
in several processes has to wait for its participants anyway.

Every user of the host can bind any abstract name, so that a name held by another user proves
nothing: then the graph decides, as between hosts. The kernel names the user that listens. (A file
instead of the name would have an owner, but neither belong to the network namespace, as the
domain does, nor be seen by other users' coordinators.) Who can publish `/clock` in the domain
can still prevent a run: DDS without security has no users.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
import errno
import os
import socket
import struct
import sys
import time

from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware.environment import finds_other_hosts
from rclpy.node import Node

_VARIABLE = 'ROS_DOMAIN_ID'
_LARGEST = 232  # DDS has no port numbers for larger ones
_CLOCK_TOPIC = '/clock'
_CHECK_S = 0.05
_CREDENTIALS = struct.Struct('@iII')  # struct ucred: process, user, group

DISCOVERY_S = 2.0
"""Time in which the packaged profile discovers the existing nodes."""


def domain_id() -> int:
    """
    Return the domain of this process.

    Raises
    ------
    ConfigError
        ROS_DOMAIN_ID is not a domain.

    """
    text = os.environ.get(_VARIABLE) or '0'
    if not text.isdecimal() or int(text) > _LARGEST:
        raise ConfigError(f'{_VARIABLE} = {text!r}, must be an integer from 0 to {_LARGEST}')
    return int(text)


@contextmanager
def sole_coordinator() -> Iterator[None]:
    """
    Hold the name of this domain's only coordinator on this host within the context.

    If another user holds it, do without: `look_for_other_coordinator` then waits for the graph.

    Raises
    ------
    ConfigError
        Another coordinator of this user holds it.

    """
    domain = domain_id()
    if sys.platform != 'linux':  # no abstract names; only the graph is checked
        yield
        return
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as claim:
        try:
            claim.bind(claim_address(domain))
            claim.listen()  # nothing is accepted: who connects reads the user of this process
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                raise
            if holder(domain) == os.geteuid():
                raise another_coordinator(domain) from None
        yield


def claim_address(domain: int) -> str:
    """Return the abstract socket name that the coordinator of a domain holds."""
    return f'\0isa_ros/coordinator/{domain}'


def holder(domain: int) -> int | None:
    """Return the user whose process listens as coordinator of a domain; None: no such process."""
    if sys.platform != 'linux':
        return None
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as end:
        end.setblocking(False)
        try:
            end.connect(claim_address(domain))
        except OSError:  # bound without listening, or too many connections: no coordinator of ours
            return None
        credentials = end.getsockopt(
            socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    return int(_CREDENTIALS.unpack(credentials)[1])


def refuse_other_coordinator(node: Node) -> None:
    """
    Refuse to run if the graph shows a second publisher of the time.

    Raises
    ------
    ConfigError
        Another node publishes `/clock`.

    """
    if node.count_publishers(_CLOCK_TOPIC) > 1:
        raise another_coordinator(node.context.get_domain_id())


def look_for_other_coordinator(
        node: Node, environment: Mapping[str, str] = os.environ) -> None:
    """
    Refuse to be the second coordinator of a network; this takes `DISCOVERY_S`.

    With discovery on this host only, the name of `sole_coordinator` is enough and there is no
    wait, unless another user holds it.

    Raises
    ------
    ConfigError
        Another node publishes `/clock`.

    """
    is_sure = holder(node.context.get_domain_id()) == os.geteuid()
    deadline = time.monotonic() + (
        DISCOVERY_S if finds_other_hosts(environment) or not is_sure else 0.0)
    refuse_other_coordinator(node)
    while (left := deadline - time.monotonic()) > 0.0:
        time.sleep(min(left, _CHECK_S))
        refuse_other_coordinator(node)


def another_coordinator(domain: int) -> ConfigError:
    """Return the error that there is another coordinator."""
    return ConfigError(
        f'another coordinator runs in {_VARIABLE} {domain}, must be the only one; end it or '
        f'set another {_VARIABLE}')
