"""Two toys on a CAN bus in this process, and their master."""

from collections.abc import Iterator

import pytest
from tests.fieldbus.canopen.toy import ToyDrive
from tests.fieldbus.canopen.virtual_bus import Master, virtual_master


@pytest.fixture
def toys() -> list[ToyDrive]:
    return [ToyDrive('hfe'), ToyDrive('kfe')]


@pytest.fixture
def master(toys: list[ToyDrive]) -> Iterator[Master]:
    with virtual_master(toys) as one:
        yield one
