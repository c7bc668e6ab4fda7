"""
Regression tests from bags, for this package and for its users.

In a conftest.py: ``pytest_plugins = ['isa_ros.testing']``; in a test::

    def test_my_leg_still_drops_like_that(assert_replays):
        assert_replays('bags/drop', 'bags/tolerances.yaml')

Without a tolerance file every bit must be equal, which holds on the machine and with the
versions that recorded the bag.
"""

from collections.abc import Callable
from pathlib import Path

from isa_ros.bag.reader import Bag
from isa_ros.bag.replay import replay
from isa_ros.bag.tolerances import load_tolerances
import pytest

AssertReplays = Callable[..., None]


def check_replay(bag: Path | str, tolerances: Path | str | None = None) -> None:
    """
    Simulate a bag again and compare every message.

    Raises
    ------
    AssertionError
        The replay differs: first tick, topic and field with both values.
    BagError, ConfigError
        The bag or the tolerance file cannot be read.

    """
    recorded = Bag(Path(bag))
    allowed = None if tolerances is None else load_tolerances(Path(tolerances), recorded.types)
    report = replay(recorded, allowed)
    if not report.is_equal:
        raise AssertionError(f'{bag}: {report}')


@pytest.fixture
def assert_replays() -> AssertReplays:
    """Return `check_replay`."""
    return check_replay
