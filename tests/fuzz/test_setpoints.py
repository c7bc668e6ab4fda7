"""Setpoints of any content are accepted as valid commands, or refused in one line."""

import math

from isa_ros import requests
from msg_adapters import setpoint
import pytest
from tests.fuzz.property import Broken
from tests.fuzz.setpoint_door import fuzz

CASES, MANY = 3000, 500_000


def test_every_setpoint_is_valid_or_refused():
    assert CASES // 4 < fuzz(CASES, 1) < CASES


@pytest.mark.long
def test_every_one_of_many_setpoints_is_valid_or_refused():
    fuzz(MANY, 2)


class Accepting:
    """A module `math` for which every value is finite."""

    nan = math.nan

    def isfinite(self, value):
        """Return True."""
        return True


@pytest.mark.parametrize('plant', [
    lambda patch: patch.setattr(setpoint, '_check', lambda *arguments: None),
    lambda patch: patch.setattr(requests, 'math', Accepting())])
def test_a_guard_that_is_missing_is_found(plant, monkeypatch):
    plant(monkeypatch)
    with pytest.raises(Broken):
        fuzz(CASES, 1)
