"""Calls of a unit that are refused or warn, with what they report."""

import pytest
from tests.export.fmi.importing import WARNING


def refused(unit, status, text, call, *arguments):
    """Assert that a call is refused with a message that has a text."""
    unit.messages.clear()
    with pytest.raises(Exception, match='failed with status'):
        call(*arguments)
    assert len(unit.messages) == 1, unit.messages
    own, message = unit.messages[0]
    assert own == status and text in message, unit.messages


def warned(unit, text, call, *arguments):
    """Assert that a call warns with a text."""
    unit.messages.clear()
    call(*arguments)
    assert [status for status, _ in unit.messages] == [WARNING], unit.messages
    assert text in unit.messages[0][1]
