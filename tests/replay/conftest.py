"""A small recorded run to compare with."""

from isa_ros.bag.reader import Bag
import pytest
from tests.bag.recorded import record
from tests.replay.ticks import N


@pytest.fixture(scope='module')
def bag(tmp_path_factory) -> Bag:
    """Return a bag of N ticks."""
    return Bag(record(tmp_path_factory.mktemp('recorded') / 'rig', N))
