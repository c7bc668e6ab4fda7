"""
The gait of a trot: which feet stand, and where those that swing go.

Diagonal feet step together. A foot stands for the part ``duty`` of its stride; from where it left
the ground it swings to the foothold, by a polynomial of fifth order, and up and down by a cubed
parabola, so that speed and acceleration are 0 at both ends of the swing.
"""

from isa_ros.examples.quadruped.parameters import TrotGains
import numpy as np

_SIXTY_FOUR = 64.0
"""4^3: the cubed parabola (u (1 - u))^3 times it has the height 1."""


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
        """Of each swing, 0 to 1; 0 of a foot that stands."""

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
        self.is_standing = phases < self._gains.duty
        self.progress = np.where(
            self.is_standing, 0.0, (phases - self._gains.duty) / (1.0 - self._gains.duty))

    def swing(self, progress: float, start: np.ndarray, end: np.ndarray) -> tuple[
            np.ndarray, np.ndarray]:
        """Return place, m, and speed, m/s, of a foot on its way from ``start`` to ``end``."""
        u, rest = progress, 1.0 - progress
        part = u * u * u * (10.0 + u * (6.0 * u - 15.0))
        rate = 30.0 * u * u * rest * rest / self.swing_s
        arc = u * rest
        place, speed = start + part * (end - start), rate * (end - start)
        lift = _SIXTY_FOUR * self._gains.lift
        place[2] += lift * arc * arc * arc
        speed[2] += 3.0 * lift * arc * arc * (1.0 - 2.0 * u) / self.swing_s
        return place, speed

    def state(self) -> list[float]:
        """Return what `restore` needs."""
        return [self.stride, float(self.is_stepping)]

    def restore(self, state: list[float]) -> None:
        """Continue from a `state`."""
        self.stride, self.is_stepping = state[0], bool(state[1])
        self._place()
        if not self.is_stepping:
            self.is_standing[:], self.progress[:] = True, 0.0
