"""
A ROS domain that no other process of this host uses, and a user's node in it.

Their settings for later processes are undone by the test's own `pytest.MonkeyPatch`.
"""

from collections.abc import Iterator
from contextlib import contextmanager
import fcntl
import os
from pathlib import Path
import socket
import tempfile

from isa_ros.nodes.middleware.domain import claim_address
from isa_ros.nodes.middleware.environment import set_defaults
import pytest
import rclpy
from rclpy.node import Node

FIRST_DOMAIN, LAST_DOMAIN = 10, 100  # 0 is the user's; above 101 ports may be ephemeral ones
_SETTINGS = (
    'FASTRTPS_DEFAULT_PROFILES_FILE', 'FASTDDS_DEFAULT_PROFILES_FILE',
    'ROS_AUTOMATIC_DISCOVERY_RANGE')


@contextmanager
def held_domain(patch: pytest.MonkeyPatch) -> Iterator[int]:
    """Hold a ROS_DOMAIN_ID that no other test of this host holds, and set it."""
    for number in range(FIRST_DOMAIN, LAST_DOMAIN + 1):
        with (Path(tempfile.gettempdir()) / f'isa_ros_domain_{number}.lock').open('w') as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                _refuse_used(number)
            except OSError:
                continue
            patch.setenv('ROS_DOMAIN_ID', str(number))
            yield number
            return
    raise RuntimeError(f'no free ROS_DOMAIN_ID in {FIRST_DOMAIN}..{LAST_DOMAIN}')


def _refuse_used(domain: int) -> None:
    """Raise OSError if a coordinator that no test holds runs there."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as name:
        name.bind(claim_address(domain))


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
