"""A master of slaves in this process."""

import pytest
from tests.fieldbus.ethercat.raw_master import in_state, PREOP, RawMaster


@pytest.fixture
def master() -> RawMaster:
    """Return the master of a slave in PREOP."""
    return in_state(PREOP)
