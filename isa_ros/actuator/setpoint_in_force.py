"""The setpoint of an actuator as it will be in force at its next tick."""

from typing import NamedTuple

from isa_ros.actuator.inbox import WITH_GAINS
from isa_ros.core.signals import GAINS_OF_COMMAND, HAS_REFERENCE, HAS_SETPOINT
import numpy as np


class SetpointInForce(NamedTuple):
    """
    What an actuator follows in SI, whether a command gave it or not.

    Where none did, position and effort are those that it took over when it was enabled, or when
    its mode changed: the effort bears its load.
    """

    position: float
    velocity: float
    effort: float
    stiffness: float
    damping: float
    reference: float | None
    """Of a mode within the force loop; None: its effort counts."""


def gain_after(pending: np.record, reu: np.record, gain: str) -> float:
    """Return one of `GAINS_OF_COMMAND` after the ``pending`` command has taken effect."""
    given = pending[gain]
    return float(given if int(pending.kinds) & WITH_GAINS and not np.isnan(given)
                 else reu.setpoint[gain])


def setpoint_after(pending: np.record, reu: np.record) -> SetpointInForce:
    """Return the setpoint of a `REU_STATE` after the ``pending`` command has taken effect."""
    kinds, own = int(pending.kinds), reu.setpoint
    motion = pending if kinds & HAS_SETPOINT else own
    stiffness, damping = (gain_after(pending, reu, gain) for gain in GAINS_OF_COMMAND)
    reference = (pending.reference if kinds & HAS_REFERENCE else
                 own.reference if own.is_reference and motion is own else None)
    return SetpointInForce(
        float(motion.position), float(motion.velocity), float(motion.effort), stiffness, damping,
        None if reference is None else float(reference))
