"""The setpoint of an actuator as it will be at the next tick."""

from isa_ros.actuator.rows import memory_of
from isa_ros.actuator.setpoint_in_force import setpoint_after
from isa_ros.core.record import row_record
from isa_ros.core.signals import HAS_ENABLE, HAS_GAINS, HAS_REFERENCE, HAS_SETPOINT
import numpy as np
import pytest

IN_FORCE = {'position': 0.05, 'velocity': 0.1, 'effort': 400.0, 'stiffness': 1e5, 'damping': 2e3,
            'reference': 1e-4, 'is_reference': 0.0}
PENDING = {'position': 0.06, 'velocity': 0.2, 'effort': 500.0, 'stiffness': np.nan,
           'damping': 3e3, 'reference': 2e-4}


def after(kinds, **changes):
    """Return the setpoint after `PENDING` with some kinds; ``changes`` are of what is in force."""
    memory = memory_of(1)
    reu, pending = row_record(memory.reu), row_record(memory.pending)
    for name, value in {**IN_FORCE, **changes}.items():
        reu.setpoint[name] = value
    for name, value in PENDING.items():
        pending[name] = value
    pending.kinds = kinds
    return setpoint_after(pending, reu)


@pytest.mark.parametrize('kinds', [0, HAS_ENABLE])
def test_without_a_setpoint_it_stays(kinds):
    assert after(kinds) == (0.05, 0.1, 400.0, 1e5, 2e3, None)
    assert after(kinds, is_reference=1.0).reference == 1e-4


def test_a_setpoint_changes_the_motion_and_the_gains_that_it_has():
    """And its effort counts from then on, not a reference before it."""
    assert after(HAS_SETPOINT, is_reference=1.0) == (0.06, 0.2, 500.0, 1e5, 3e3, None)


def test_gains_alone_leave_the_motion():
    assert after(HAS_GAINS) == (0.05, 0.1, 400.0, 1e5, 3e3, None)


def test_a_reference_leaves_the_motion_and_the_gains():
    assert after(HAS_REFERENCE) == (0.05, 0.1, 400.0, 1e5, 2e3, 2e-4)
    assert after(HAS_REFERENCE | HAS_SETPOINT).reference == 2e-4
