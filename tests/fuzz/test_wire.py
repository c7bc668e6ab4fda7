"""Altered messages on the private wire never end a participant or a coordinator by surprise."""

from isa_ros.nodes.lockstep import answer_checks
from isa_ros.nodes.lockstep.roles import ActuatorRole
from isa_ros.run.wire import header, parts, steps
import pytest
from tests.fuzz.property import Broken
from tests.fuzz.wire_door import fuzz

CASES, MANY = 3000, 300_000


def test_every_message_is_taken_or_discarded():
    fuzz(CASES, 1)


@pytest.mark.long
def test_every_one_of_many_messages_is_taken_or_discarded():
    fuzz(MANY, 2)


@pytest.mark.parametrize('plant', [
    lambda patch: patch.setattr(header, 'WireError', ZeroDivisionError),
    lambda patch: patch.setattr(parts, 'is_finite', lambda values: True),
    lambda patch: patch.setattr(parts, 'refuse_command', lambda command: None),
    lambda patch: patch.setattr(ActuatorRole, 'check', lambda self, step: None),
    lambda patch: patch.setattr(answer_checks, 'refuse_requests', lambda parts, n: None),
    lambda patch: patch.setattr(steps, '_refuse_hello', lambda step: None)])
def test_a_guard_that_is_missing_is_found(plant, monkeypatch):
    plant(monkeypatch)
    with pytest.raises(Broken):
        fuzz(CASES, 1)
