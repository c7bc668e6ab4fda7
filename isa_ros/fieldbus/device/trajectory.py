"""
A reference that moves to a target with bounded speed, acceleration and deceleration, tick by tick.

With the step T a reference of speed v that brakes with d from this tick on comes to rest after
v T + (v - d T) T + ... = v^2 / 2d + v T / 2; the speed that just stops at a distance s is
v = d (sqrt(T^2 / 4 + 2 s / d) - T / 2). Units are m or rad, and s.
"""

import math


class Trajectory:
    """Position and velocity of the reference; it begins at rest."""

    def __init__(self, step: float) -> None:
        self._step = step
        self.position = self.velocity = 0.0

    def begin(self, position: float, velocity: float = 0.0) -> None:
        """Begin anew."""
        self.position, self.velocity = position, velocity

    def advance(
            self, target: float, speed: float, acceleration: float, deceleration: float) -> None:
        """Move for a tick; ``speed`` >= 0, both accelerations > 0."""
        distance, step = target - self.position, self._step
        wanted = math.copysign(min(speed, self.braked(target, deceleration)), distance)
        speeds_up = wanted * self.velocity >= 0.0 and abs(wanted) > abs(self.velocity)
        change = (acceleration if speeds_up else deceleration) * step
        self.velocity = min(max(wanted, self.velocity - change), self.velocity + change)
        if (self.velocity * distance >= 0.0 and abs(distance) <= abs(self.velocity) * step
                and abs(self.velocity) <= deceleration * step):     # it can stop there
            self.position, self.velocity = target, 0.0
        else:
            self.position += self.velocity * step

    def braked(self, target: float, deceleration: float) -> float:
        """Return the largest speed, >= 0, that just stops at ``target``."""
        distance, step = abs(target - self.position), self._step
        return deceleration * (
            math.sqrt(0.25 * step * step + 2.0 * distance / deceleration) - 0.5 * step)

    def stop(self, deceleration: float) -> None:
        """Brake for a tick; ``deceleration`` > 0."""
        change = deceleration * self._step
        self.velocity = min(max(0.0, self.velocity - change), self.velocity + change)
        self.position += self.velocity * self._step
