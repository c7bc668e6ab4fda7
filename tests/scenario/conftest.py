"""Shipped runs that scenarios are read for."""

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_file import load_run
import pytest


@pytest.fixture(scope='session')
def leg() -> RunConfig:
    """Return the shipped leg."""
    return load_run(find('leg', CONFIG))


@pytest.fixture(scope='session')
def rotary() -> RunConfig:
    """Return the shipped rotary rig."""
    return load_run(find('rig_rotary', CONFIG))
