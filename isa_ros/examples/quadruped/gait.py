"""
The gait of a trot: which feet stand, and where those that swing go.

Diagonal feet step together. A foot stands for the part ``duty`` of its stride; from where it left
the ground it swings to the foothold, by a polynomial of fifth order, and up and down by a cubed
parabola, so that speed and acceleration are 0 at both ends of the swing.
"""

from typing import NamedTuple

from isa_ros.core.kernel import kernel
from isa_ros.examples.quadruped.parameters import TrotGains
import numpy as np

_SIXTY_FOUR = 64.0
"""4^3: the cubed parabola (u (1 - u))^3 times it has the height 1."""


@kernel
def swing_way(u, seconds, lift, start, end, place, speed):
    """
    Fill place, m, and speed, m/s, of a foot at the part u of its way from ``start`` to ``end``.

    The swing takes ``seconds``. Along all axes s = u^3 (10 - 15 u + 6 u^2), and upwards
    64 lift (u (1 - u))^3.
    """
    part = u * u * u * (10.0 + u * (6.0 * u - 15.0))
    rate = 30.0 * u * u * (1.0 - u) * (1.0 - u) / seconds
    for a in range(3):
        place[a] = start[a] + part * (end[a] - start[a])
        speed[a] = rate * (end[a] - start[a])
    arc = u * (1.0 - u)
    place[2] += _SIXTY_FOUR * lift * arc * arc * arc
    speed[2] += 3.0 * _SIXTY_FOUR * lift * arc * arc * (1.0 - 2.0 * u) / seconds


@kernel
def swing_feet(trunk, progress, seconds, holds, gains, feet, velocities, lifted, ways, forces):
    """
    Fill the forces that pull swinging feet along their ways to their footholds, (f, 3).

    ``trunk`` is its place and velocity, (6,), ``holds`` the footholds at the end of the swing as
    seen now, (f, 2), ``gains`` lift, press, stiffness and damping, ``feet`` and ``velocities`` as
    in `isa_ros.examples.quadruped.legs.Legs`, ``lifted`` where each foot left the ground; ``ways``
    is memory, (3, 3).
    """
    lift, press, stiffness, damping = gains
    end, place, speed = ways[0], ways[1], ways[2]
    for i in range(len(feet)):
        if progress[i] <= 0.0:
            continue
        left = (1.0 - progress[i]) * seconds
        end[0] = holds[i, 0] + trunk[3] * left
        end[1] = holds[i, 1] + trunk[4] * left
        end[2] = -press
        swing_way(progress[i], seconds, lift, lifted[i], end, place, speed)
        for a in range(3):
            forces[i, a] = (
                stiffness * (place[a] - trunk[a] - feet[i, a])
                + damping * (speed[a] - trunk[3 + a] - velocities[i, a]))


class Swinging(NamedTuple):
    """Memory of `swing`; as `swing_feet` has it."""

    trunk: np.ndarray
    progress: np.ndarray
    seconds: np.ndarray
    """(1,)."""
    holds: np.ndarray
    gains: np.ndarray
    """(4,)."""
    feet: np.ndarray
    velocities: np.ndarray
    lifted: np.ndarray
    ways: np.ndarray
    forces: np.ndarray


@kernel
def swing(own):
    """Fill the forces of swinging feet; return 0."""
    gains = own.gains
    swing_feet(own.trunk, own.progress, own.seconds[0], own.holds,
               (gains[0], gains[1], gains[2], gains[3]), own.feet, own.velocities, own.lifted,
               own.ways, own.forces)
    return 0


class Gait:
    """
    The phases of four feet in the order front left, front right, hind left, hind right.

    It starts and stops while all feet stand.
    """

    OFFSETS = np.array([0.0, 0.5, 0.5, 0.0])

    def __init__(self, gains: TrotGains) -> None:
        self._gains = gains
        self.stand_s = gains.duty / gains.frequency
        """Time for which a foot stands, s."""
        self.swing_s = (1.0 - gains.duty) / gains.frequency
        self.stride = 0.0
        """Part of the stride of the first foot; a stride begins as it lands."""
        self.is_stepping = False
        self.is_standing = np.ones(4, bool)
        """Of each foot."""
        self.progress = np.zeros(4)
        """Of each swing, 0 to 1; 0 of a foot that stands, above 0 of one that swings."""

    def advance(self, seconds: float, wants_steps: bool) -> None:
        """Advance by a time; `is_standing` and `progress` are those of its end."""
        if not self.is_stepping:
            if not wants_steps:
                return
            self.is_stepping, self.stride = True, 0.0
        else:
            self.stride = (self.stride + seconds * self._gains.frequency) % 1.0
        self._place()
        if not wants_steps and self.is_standing.all():
            self.is_stepping = False

    def _place(self) -> None:
        phases = (self.stride + self.OFFSETS) % 1.0
        swings = (phases - self._gains.duty) / (1.0 - self._gains.duty)
        self.is_standing = swings <= 0.0
        self.progress = np.where(self.is_standing, 0.0, swings)

    def state(self) -> list[float]:
        """Return what `restore` needs."""
        return [self.stride, float(self.is_stepping)]

    def restore(self, state: list[float]) -> None:
        """Continue from a `state`."""
        self.stride, self.is_stepping = state[0], bool(state[1])
        self._place()
        if not self.is_stepping:
            self.is_standing[:], self.progress[:] = True, 0.0
