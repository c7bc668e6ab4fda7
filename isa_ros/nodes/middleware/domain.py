"""
One coordinator per ROS domain and host.

The graph shows another coordinator only once it is discovered, 0.1 s to more than a second
after the start. On one host, where discovery stays by default, a name in the kernel says so
at once: it belongs to the network namespace and vanishes with the process that holds it. Where
other hosts are found too, a run in one process waits for the graph; one in processes has to
wait for its participants anyway.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
import errno
import os
import socket
import sys
import time

from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware.environment import finds_other_hosts
from rclpy.node import Node

_VARIABLE = 'ROS_DOMAIN_ID'
_LARGEST = 232  # above it DDS has no port numbers
_CLOCK_TOPIC = '/clock'
_LOOK_S = 0.05

DISCOVERY_S = 2.0
"""In which the packaged profile finds who is there already."""


def domain_id() -> int:
    """
    Return the domain of this process.

    Raises
    ------
    ConfigError
        ROS_DOMAIN_ID is no domain.

    """
    text = os.environ.get(_VARIABLE) or '0'
    if not text.isdecimal() or int(text) > _LARGEST:
        raise ConfigError(f'{_VARIABLE} = {text!r}, must be an integer from 0 to {_LARGEST}')
    return int(text)


@contextmanager
def sole_coordinator() -> Iterator[None]:
    """
    Be the only coordinator of this domain on this host while the context lasts.

    Raises
    ------
    ConfigError
        There is one already.

    """
    domain = domain_id()
    if sys.platform != 'linux':  # abstract names are Linux's; the graph is left
        yield
        return
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as claim:
        try:
            claim.bind(claim_address(domain))
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                raise
            raise another_coordinator(domain) from None
        yield


def claim_address(domain: int) -> str:
    """Return the abstract socket name that the coordinator of a domain holds."""
    return f'\0isa_ros/coordinator/{domain}'


def refuse_other_coordinator(node: Node) -> None:
    """
    Refuse to be the second one that publishes the time, as far as the graph is known.

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
    Refuse to be the second coordinator of a network, which takes `DISCOVERY_S` to be sure of.

    On one host `sole_coordinator` knows at once.

    Raises
    ------
    ConfigError
        Another node publishes `/clock`.

    """
    deadline = time.monotonic() + (DISCOVERY_S if finds_other_hosts(environment) else 0.0)
    refuse_other_coordinator(node)
    while (left := deadline - time.monotonic()) > 0.0:
        time.sleep(min(left, _LOOK_S))
        refuse_other_coordinator(node)


def another_coordinator(domain: int) -> ConfigError:
    """Return the error of a coordinator that is not alone."""
    return ConfigError(
        f'another coordinator runs in {_VARIABLE} {domain}, must be the only one; end it or '
        f'set another {_VARIABLE}')
