"""A rig with drives on a bus, for every test that masters it."""

import pytest

from .rig import Rig


@pytest.fixture
def rig():
    return Rig()
