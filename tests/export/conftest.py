"""The library of an actuator that most tests of a library call."""

from isa_ros.export.chosen import choose
from isa_ros.export.exported import exported
import pytest
from tests.export.libraries import Loaded, written


@pytest.fixture(scope='session')
def own():
    """Return an ISA v5 whose load is that of the caller."""
    return exported(choose('isa_v5', {'reu.force.kp': 9.5e-08}))


@pytest.fixture(scope='session')
def path(own, tmp_path_factory):
    """Return the path of its library."""
    return written(own, tmp_path_factory.mktemp('isa_v5'))


@pytest.fixture(scope='session')
def loaded(path):
    """Return its functions."""
    return Loaded(path, 'isa_v5')
