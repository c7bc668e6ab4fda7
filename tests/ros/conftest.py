"""A ROS domain of its own for every test."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from rclpy.node import Node
from tests.ros.domains import held_domain, observing
from tests.ros.faults import WHEEL_SINE
from tests.ros.started import bringup, RIG


@pytest.fixture
def domain() -> Iterator[int]:
    """Return a ROS_DOMAIN_ID that no other test of this host holds, and set it."""
    with held_domain() as number:
        yield number


@pytest.fixture
def observer(domain: int) -> Iterator[Node]:
    """Return a user's node in the domain."""
    with observing() as node:
        yield node


@pytest.fixture(scope='session')
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the bag of the rig with `WHEEL_SINE` in one process, without any fault."""
    bag = tmp_path_factory.mktemp('undisturbed') / 'bag'
    with held_domain(), bringup(bag, *WHEEL_SINE, '--in-process', config=RIG) as run:
        assert run.exit_code() == 0, run.errors
    return bag
