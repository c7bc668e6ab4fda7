"""
One coordinator per namespace of a ROS domain, on one host or on several.

The ROS graph shows another coordinator only after its discovery, 0.1 s to more than a second
after the start. On one host, to which discovery is limited by default, an abstract socket name
detects it at once: the name belongs to the network namespace and is released with the process
that holds it. If other hosts are discovered too, a run in one process waits for the graph; a run
in several processes has to wait for its participants anyway.

A launch file holds the name before it starts anything, so that the actuators of a second launch
are never started beside those of the first; its coordinator is told which process holds it.

Every user of the host can bind any abstract name, so that a name held by another user proves
nothing: then the graph decides, as between hosts. The kernel names the user that listens. (A file
instead of the name would have an owner, but neither belong to the network namespace, as the
domain does, nor be seen by other users' coordinators.) Who can publish the time in the namespace
can still prevent a run: DDS without security has no users.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
import errno
from hashlib import sha256
import os
import socket
import struct
import sys
import time
from typing import NamedTuple

from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware.environment import finds_other_hosts
from isa_ros.processes.domain_id import domain_id, DOMAIN_VARIABLE
from rclpy.node import Node

CLAIMED_BY = 'ISA_ROS_CLAIMED_BY'
"""Environment variable of a coordinator: the process that holds the name for it, a launch."""

COORDINATOR = 'coordinator'
"""Name of the node."""

_CLOCK_TOPIC = 'clock'  # relative: of the namespace
_CHECK_S = 0.05
_DIGEST_LETTERS = 32
_CREDENTIALS = struct.Struct('@iII')  # struct ucred: process, user, group

DISCOVERY_S = 2.0
"""Time in which the packaged profile discovers the existing nodes."""


class Holder(NamedTuple):
    """Who listens at a name."""

    process: int
    user: int


class Claim:
    """
    Holds a name of the only one in a namespace, on this host, until it is closed.

    ``node`` is the name of an actuator alone; by default it is that of the coordinator. If another
    user holds it, it is not held: `look_for_other_coordinator` then waits for the graph. Nor
    is it where it is held by the process that `CLAIMED_BY` names.

    Raises
    ------
    ConfigError
        Another process of this user holds it, or ROS_DOMAIN_ID is not a domain.

    """

    def __init__(self, namespace: str = '', node: str = COORDINATOR) -> None:
        domain = domain_id()
        self._socket: socket.socket | None = None
        if sys.platform != 'linux':  # no abstract names; only the graph is checked
            return
        made = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            made.bind(claim_address(domain, namespace, node))
            made.listen()  # nothing is accepted: who connects reads the user of this process
        except OSError as error:
            made.close()
            if error.errno != errno.EADDRINUSE:
                raise
            found = holder(domain, namespace, node)
            if found is not None and found.user == os.geteuid() and (
                    str(found.process) != os.environ.get(CLAIMED_BY)):
                raise (another_coordinator(domain, namespace) if node == COORDINATOR
                       else _another_node(domain, namespace, node)) from None
            return
        self._socket = made

    def close(self) -> None:
        """Release the name."""
        if self._socket is not None:
            self._socket.close()


@contextmanager
def sole_coordinator(namespace: str = '') -> Iterator[None]:
    """Hold the `Claim` of a namespace within the context."""
    claim = Claim(namespace)
    try:
        yield
    finally:
        claim.close()


def claim_address(domain: int, namespace: str = '', node: str = COORDINATOR) -> str:
    """Return the abstract socket name that the only node of this name holds."""
    name = f'{namespace.strip("/")}/{node}'.strip('/')
    # A digest: a name of ROS may be longer than that of a socket.
    own = name if name == COORDINATOR else sha256(name.encode()).hexdigest()[:_DIGEST_LETTERS]
    return f'\0isa_ros/{own}/{domain}'


def holder(domain: int, namespace: str = '', node: str = COORDINATOR) -> Holder | None:
    """Return who listens as the node of a namespace; None: no process."""
    if sys.platform != 'linux':
        return None
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as end:
        end.setblocking(False)
        try:
            end.connect(claim_address(domain, namespace, node))
        except OSError:  # bound without listening, or too many connections: no coordinator of ours
            return None
        credentials = end.getsockopt(
            socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    process, user, _ = _CREDENTIALS.unpack(credentials)
    return Holder(process, user)


def refuse_other_coordinator(node: Node) -> None:
    """
    Refuse to run if the graph shows a second publisher of the time in the node's namespace.

    Raises
    ------
    ConfigError
        Another node publishes `clock`.

    """
    if node.count_publishers(_CLOCK_TOPIC) > 1:
        raise another_coordinator_of(node)


def look_for_other_coordinator(
        node: Node, environment: Mapping[str, str] = os.environ) -> None:
    """
    Refuse to be the second coordinator of a network; this takes `DISCOVERY_S`.

    With discovery on this host only, the name of `sole_coordinator` is enough and there is no
    wait, unless another user holds it.

    Raises
    ------
    ConfigError
        Another node publishes `clock` in the same namespace.

    """
    found = holder(node.context.get_domain_id(), node.get_namespace())
    is_sure = found is not None and found.user == os.geteuid()
    deadline = time.monotonic() + (
        DISCOVERY_S if finds_other_hosts(environment) or not is_sure else 0.0)
    refuse_other_coordinator(node)
    while (left := deadline - time.monotonic()) > 0.0:
        time.sleep(min(left, _CHECK_S))
        refuse_other_coordinator(node)


def another_coordinator_of(node: Node) -> ConfigError:
    """Return the error that there is another coordinator in the namespace of a node."""
    return another_coordinator(node.context.get_domain_id(), node.get_namespace())


def another_coordinator(domain: int, namespace: str) -> ConfigError:
    """Return the error that there is another coordinator in a namespace."""
    return ConfigError(
        f'another coordinator runs in {DOMAIN_VARIABLE} {domain}, namespace '
        f'/{namespace.strip("/")}, must be the only one; end it, or use another namespace or '
        f'{DOMAIN_VARIABLE}')


def _another_node(domain: int, namespace: str, node: str) -> ConfigError:
    path = f'{namespace.rstrip("/")}/{node}'
    return ConfigError(
        f'{path}: another actuator of this name runs alone in {DOMAIN_VARIABLE} {domain}; end it, '
        f'or set another name (-r __node:=NAME), namespace or {DOMAIN_VARIABLE}')
