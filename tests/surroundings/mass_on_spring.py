"""A mechanism with closed solutions: a cart on a spring between two cylinders of other levers."""

import isa_ros
import numpy as np

MASS, STIFFNESS, DAMPING, WEIGHT = 40.0, 2e5, 300.0, 390.0      # kg, N/m, N s/m, N
LEVERS = np.array([1.0, -0.5])
"""Speed of each actuator per speed of the cart: the second retracts as the first extends."""
OFFSETS = np.array([0.04, 0.06])    # m, of the actuators at t = 0


class MassOnSpring:
    """m q'' = J^T f - k q - c q' - W, x = x_0 + J q; its step is exact in each window."""

    def __init__(self, mounting: isa_ros.Mounting | None = None) -> None:
        self.state = np.zeros(2)
        self.provenance = {'simulator': 'by hand 1.0'}
        self.motions = 0

    def motion(self, state: np.ndarray, forces: np.ndarray) -> isa_ros.Motion:
        """Return the motion, exact."""
        self.motions += 1
        q, v = state
        a = (LEVERS @ forces - STIFFNESS * q - DAMPING * v - WEIGHT) / MASS
        return isa_ros.Motion(OFFSETS + LEVERS * q, LEVERS * v, LEVERS * a, np.array([a]))

    def displaced(self, state: np.ndarray, dq: np.ndarray, dv: np.ndarray) -> np.ndarray:
        """Return the state moved."""
        return state + np.array([dq[0], dv[0]])

    def stepped(self, state: np.ndarray, forces: np.ndarray, seconds: float) -> np.ndarray:
        """Return q and q' from the solution of the damped oscillator."""
        q, v = state
        gamma, h = 0.5 * DAMPING / MASS, seconds / len(forces)
        w = np.sqrt(STIFFNESS / MASS - gamma * gamma)
        for row in forces:
            rest = (LEVERS @ row - WEIGHT) / STIFFNESS
            a, b = q - rest, (v + gamma * (q - rest)) / w
            fade, c, s = np.exp(-gamma * h), np.cos(w * h), np.sin(w * h)
            q, v = (rest + fade * (a * c + b * s),
                    fade * ((b * w - gamma * a) * c - (a * w + gamma * b) * s))
        return np.array([q, v])


def Turned(mounting: isa_ros.Mounting) -> MassOnSpring:  # noqa: N802, as a class in a run file
    """Return it, made by a run file."""
    return MassOnSpring(mounting)
