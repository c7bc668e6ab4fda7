"""A ROS domain of its own for every test."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from rclpy.node import Node
from tests.ros.domains import held_domain, observing
from tests.ros.faults import WHEEL_SINE, with_timeout
from tests.ros.lone_participant import Participant
from tests.ros.started import bringup, DEADLINE_S


@pytest.fixture
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """Return a ROS_DOMAIN_ID that no other test of this host holds, and set it."""
    with held_domain(monkeypatch) as number:
        yield number


@pytest.fixture
def observer(domain: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[Node]:
    """Return a user's node in the domain."""
    with observing(monkeypatch) as node:
        yield node


@pytest.fixture
def member(observer: Node) -> Iterator[Participant]:
    """Return a participant in a run that has begun."""
    node = Node('kfe', context=observer.context, enable_rosout=False,
                start_parameter_services=False)
    yield Participant(node)
    node.destroy_node()


@pytest.fixture(scope='session')
def patient_rig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the configuration of the rig with a timeout that no test reaches."""
    return with_timeout(tmp_path_factory.mktemp('patient') / 'rig.yaml', DEADLINE_S)


@pytest.fixture(scope='session')
def undisturbed(tmp_path_factory: pytest.TempPathFactory, patient_rig: Path) -> Path:
    """Return the bag of that rig with `WHEEL_SINE` in one process, without any fault."""
    bag = tmp_path_factory.mktemp('undisturbed') / 'bag'
    with pytest.MonkeyPatch.context() as patch, held_domain(patch), \
            bringup(bag, *WHEEL_SINE, '--in-process', config=patient_rig) as run:
        assert run.exit_code() == 0, run.errors
    return bag
