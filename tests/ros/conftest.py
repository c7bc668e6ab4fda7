"""A ROS domain of its own for every test."""

from collections.abc import Iterator
import fcntl
from pathlib import Path
import tempfile

from isa_ros.nodes.environment import set_defaults
import pytest
import rclpy
from rclpy.node import Node

FIRST_DOMAIN, LAST_DOMAIN = 10, 100  # 0 is the user's; above 101 ports meet ephemeral ones


@pytest.fixture
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """Return a ROS_DOMAIN_ID that no other test of this host holds, and set it."""
    for number in range(FIRST_DOMAIN, LAST_DOMAIN + 1):
        with (Path(tempfile.gettempdir()) / f'isa_ros_domain_{number}.lock').open('w') as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                continue
            monkeypatch.setenv('ROS_DOMAIN_ID', str(number))
            yield number
            return
    pytest.fail(f'no free ROS_DOMAIN_ID in {FIRST_DOMAIN}..{LAST_DOMAIN}')


@pytest.fixture
def observer(domain: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[Node]:
    """Return a user's node in the domain."""
    for name in ('FASTRTPS_DEFAULT_PROFILES_FILE', 'FASTDDS_DEFAULT_PROFILES_FILE',
                 'ROS_AUTOMATIC_DISCOVERY_RANGE'):
        monkeypatch.delenv(name, raising=False)
    defaults: dict[str, str] = {}
    set_defaults(defaults)
    for name, value in defaults.items():
        monkeypatch.setenv(name, value)
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain)
    node = Node('observer', context=context, enable_rosout=False)
    yield node
    node.destroy_node()
    rclpy.shutdown(context=context)
