"""What a `COMMAND` on the wire may be: the same by Python and compiled."""

from typing import Any

from isa_ros.core.device import MODES
from isa_ros.core.kernel import kernel
from isa_ros.core.signals import (
    COMMAND, EVERY_KIND, HAS_CLEAR_FAULT, HAS_ENABLE, HAS_GAINS, HAS_MODE, HAS_REFERENCE,
    HAS_SETPOINT, WAS_REFUSED)
from isa_ros.run.wire.header import WireError
from isa_ros.run.wire.parts import is_valid_command, refuse_command
import numpy as np
import pytest

NAN, INF = np.nan, np.inf
_LAST_STEP = 2**46
LAST_MODE = len(MODES) - 1


@kernel
def compiled(commands, known):
    """Return whether a command is valid."""
    return is_valid_command(commands[0], known)


def command(**values: Any) -> np.ndarray:
    """Return a row of which only the given fields are valid, but for its time."""
    row = np.zeros(1, COMMAND)
    for name in 'position', 'velocity', 'effort', 'reference':
        row[name] = NAN
    row['stiffness'] = row['damping'] = -1.0
    row['is_enabled'], row['mode'] = 7, 0
    for name, value in values.items():
        row[name] = value
    return row


SETPOINT = {'kinds': HAS_SETPOINT, 'position': 1.0, 'velocity': 2.0, 'effort': 3.0,
            'stiffness': NAN, 'damping': NAN}
GAINS = {'kinds': HAS_GAINS, 'stiffness': 4.0, 'damping': 0.0}
REFERENCE = {'kinds': HAS_REFERENCE, 'mode': 1, 'reference': 5.0}

VALID = [
    {'kinds': 0, 'due_step': -1}, SETPOINT, GAINS, REFERENCE, {'kinds': HAS_CLEAR_FAULT},
    {'kinds': HAS_CLEAR_FAULT, 'due_step': _LAST_STEP},
    {'kinds': HAS_ENABLE, 'is_enabled': 0}, {'kinds': HAS_ENABLE, 'is_enabled': 1},
    {'kinds': HAS_MODE, 'mode': 1}, {'kinds': HAS_MODE, 'mode': LAST_MODE},
    SETPOINT | {'stiffness': 0.0, 'damping': 6.0}, GAINS | {'damping': NAN}]
INVALID = [
    {'kinds': HAS_CLEAR_FAULT, 'due_step': -1},
    {'kinds': HAS_CLEAR_FAULT, 'due_step': _LAST_STEP + 1},
    {'kinds': HAS_ENABLE}, {'kinds': HAS_MODE}, {'kinds': HAS_MODE, 'mode': LAST_MODE + 1},
    {'kinds': HAS_MODE, 'mode': -1}, REFERENCE | {'mode': 0}, REFERENCE | {'reference': INF},
    {'kinds': WAS_REFUSED}, {'kinds': 2**31}, SETPOINT | {'position': INF},
    SETPOINT | {'velocity': NAN}, SETPOINT | {'effort': -INF}, SETPOINT | {'stiffness': INF},
    SETPOINT | {'damping': -1e-9}, GAINS | {'stiffness': -1.0}, GAINS | {'damping': INF}]


@pytest.mark.parametrize('values, is_valid', [
    *((values, True) for values in VALID), *((values, False) for values in INVALID)])
def test_a_command_is_valid_or_refused(values, is_valid):
    row = command(**values)
    assert is_valid_command(row[0], EVERY_KIND) is is_valid
    assert compiled(row.view(np.recarray), EVERY_KIND) == is_valid
    if is_valid:
        refuse_command(row[0])
    else:
        with pytest.raises(WireError, match='invalid kind, number or gain'):
            refuse_command(row[0])


def test_what_is_known_depends_on_the_end():
    row = command(kinds=HAS_ENABLE | WAS_REFUSED, is_enabled=1)
    assert not is_valid_command(row[0], EVERY_KIND)
    assert is_valid_command(row[0], EVERY_KIND | WAS_REFUSED)
    assert compiled(row.view(np.recarray), EVERY_KIND | WAS_REFUSED)
