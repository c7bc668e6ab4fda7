"""What a user's controller sees and has to have; its setpoints are tested in test_requests.py."""

from isa_ros.controller import by_name, Controller, only_of
from isa_ros.core.record import rows_of
from isa_ros.core.signals import SAMPLE
from isa_ros.errors import RunError
import numpy as np
import pytest


def test_a_controller_that_keeps_nothing_says_so_itself():
    """Its state would be lost, so saving is refused until it has a snapshot()."""
    with pytest.raises(RunError, match=r'Controller has no snapshot\(\)'):
        Controller().snapshot()
    with pytest.raises(RunError, match=r'Controller has no restore\(\)'):
        Controller().restore(b'')


def test_the_body_of_a_state_is_the_only_one():
    left, right = (rows_of(1, SAMPLE)[0] for _ in range(2))
    assert only_of({}) is None and only_of({'left': left, 'right': right}) is None
    assert only_of({'left': left}) is left


def test_samples_by_name_are_rows_of_the_memory_itself():
    rows = np.zeros(2, SAMPLE)
    found = by_name(['haa', 'hfe'], rows)
    rows['position'][:] = 0.25, 0.5
    assert [(name, own.position) for name, own in found.items()] == [('haa', 0.25), ('hfe', 0.5)]
