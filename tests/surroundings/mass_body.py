"""Bodies of a mass on a spring, mounted on two of five actuators."""

from isa_ros.core.signals import LOAD_REPLY
from isa_ros.surroundings.mechanism import Mounting
from isa_ros.surroundings.mechanism_body import MechanismBody
import numpy as np
from tests.surroundings.mass_on_spring import MassOnSpring, OFFSETS

STEP = 1e-3
ROWS = np.array([3, 1])
N = 5


def mounting(step: float = STEP) -> Mounting:
    return Mounting(['out', 'back'], ROWS, OFFSETS, [False, True], step, 0)


def moving_body(has_response: bool) -> MechanismBody:
    """Return a body that has moved for some ticks under changing forces."""
    body = MechanismBody(MassOnSpring(), mounting(), has_response=has_response)
    for tick in range(4):
        body.advance(replies_of(np.array([[500.0 + 90.0 * tick], [200.0]])
                                + np.array([[3.0], [-5.0]]) * np.arange(5)))
    return body


def replies_of(means: np.ndarray) -> np.ndarray:
    replies = np.zeros(N, LOAD_REPLY)
    replies['mean_forces'][ROWS], replies['force'][ROWS] = means, means[:, -1]
    return replies
