"""
A ROS domain that no other process of this host uses, and a user's node in it.

Their settings for later processes are undone by the test's own `pytest.MonkeyPatch`.
"""

from collections.abc import Iterator
from contextlib import contextmanager
import os
import socket

from isa_ros.nodes.middleware.domain import claim_address
from isa_ros.nodes.middleware.environment import set_defaults
import pytest
import rclpy
from rclpy.node import Node

FIRST_DOMAIN, LAST_DOMAIN = 10, 100  # 0 is the user's; above 101 ports may be ephemeral
# Ports of a domain, DDSI-RTPS 9.6.2.3: two for multicast, from the tenth on two a participant.
DOMAIN_0_PORT, PORTS_OF_A_DOMAIN = 7400, 250
CLAIM_PORT, FIRST_UNICAST_PORT = 9, 10
N_PARTICIPANTS = 32  # of a host, as the packaged profile looks for them
LOOPBACK = '127.0.0.1'
_SETTINGS = (
    'FASTRTPS_DEFAULT_PROFILES_FILE', 'FASTDDS_DEFAULT_PROFILES_FILE',
    'ROS_AUTOMATIC_DISCOVERY_RANGE')


@contextmanager
def held_domain(patch: pytest.MonkeyPatch) -> Iterator[int]:
    """
    Hold a ROS_DOMAIN_ID that no other test of this host holds, and set it.

    What holds it is a port that DDS leaves unused. It belongs to the network namespace, as the
    domain does, and is free again when this process has ended, however that was. From the last
    domain down: users begin with the first.
    """
    for number in range(LAST_DOMAIN, FIRST_DOMAIN - 1, -1):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as claim:
            try:
                claim.bind((LOOPBACK, port(number, CLAIM_PORT)))
                refuse_used(number)
            except OSError:
                continue
            patch.setenv('ROS_DOMAIN_ID', str(number))
            yield number
            return
    raise RuntimeError(f'no free ROS_DOMAIN_ID in {FIRST_DOMAIN}..{LAST_DOMAIN}')


def port(domain: int, offset: int) -> int:
    """Return one of the ports of a domain."""
    return DOMAIN_0_PORT + PORTS_OF_A_DOMAIN * domain + offset


def refuse_used(domain: int) -> None:
    """Raise OSError if a coordinator, or any participant, that no test holds is there."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as name:
        name.bind(claim_address(domain))
    for k in range(N_PARTICIPANTS):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as discovery:
            discovery.bind((LOOPBACK, port(domain, FIRST_UNICAST_PORT + 2 * k)))


@contextmanager
def observing(patch: pytest.MonkeyPatch) -> Iterator[Node]:
    """Return a node in the domain that is set, with the packaged middleware settings."""
    for name in _SETTINGS:
        patch.delenv(name, raising=False)
    defaults: dict[str, str] = {}
    set_defaults(defaults)
    for name, value in defaults.items():
        patch.setenv(name, value)
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=int(os.environ['ROS_DOMAIN_ID']))
    node = Node('observer', context=context, enable_rosout=False)
    try:
        yield node
    finally:
        node.destroy_node()
        rclpy.shutdown(context=context)
