"""
A hydraulic motor: it turns without an end, and two points of its sheet give its losses.

Chamber A drives it forwards. Both chambers keep their volume, what the shaft takes from one it
gives to the other (M6). Leakage is laminar, friction Coulomb's and viscous (M7, M8), so that the
efficiencies of the sheet come out again where they are the only losses. Neglected: the ripple of
the pistons, a case drain of its own, and that the oil expands on its way through.
"""

import math
from typing import NamedTuple

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import numbers, parameter, Parameters
from isa_ros.core.units import MILLILITRE, MPA, PERCENT
from isa_ros.errors import ParameterError
from isa_ros.plant.drives import rated_pressure
import numpy as np

RPM = 2.0 * math.pi / 60.0      # rad/s
_AGREES = 2.0       # ratio of the leakages of two points that are still one laminar leakage
_DIFFERS = 1.2      # ratio of the speeds of two points that tell Coulomb from viscous friction


class Losses(NamedTuple):
    """Laminar leakage, m3/s/Pa, Coulomb friction, Nm, and viscous friction, Nms/rad."""

    leakage: float
    coulomb: float
    viscous: float


@frozen(kw_only=True)
class Motor(Parameters):
    """Motor of constant displacement, with its efficiencies at two points."""

    displacement_cc_per_rad: float = parameter('displacement D', 'cc/rad', ge=1e-3, le=1000.0)
    pressure_mpa: tuple[float, ...] = numbers(
        'drop from port to port at two points', 'MPa', least=2, most=2, gt=0.0, le=70.0)
    speed_rpm: tuple[float, ...] = numbers(
        'speed at these points', 'rpm', least=2, most=2, gt=0.0, le=2e4)
    volumetric_percent: tuple[float, ...] = numbers(
        'volumetric efficiency at these points', '%', least=2, most=2, ge=10.0, le=100.0)
    mechanical_percent: tuple[float, ...] = numbers(
        'mechanical efficiency at these points', '%', least=2, most=2, ge=10.0, lt=100.0)
    rated_pressure_mpa: float = rated_pressure()

    def __post_init__(self) -> None:
        """Refuse points that no laminar leakage or no friction has."""
        super().__post_init__()
        self.losses()

    @property
    def areas(self) -> tuple[float, float]:
        """Return (D, D) in m3/rad."""
        displacement = self.displacement_cc_per_rad * MILLILITRE
        return displacement, displacement

    @property
    def stroke(self) -> float:
        """Return one turn in rad, in which it starts."""
        return 2.0 * math.pi

    def efficiencies(self, k: int) -> tuple[float, float]:
        """Return the volumetric and the mechanical one of the losses at point ``k``, 1."""
        displacement = self.displacement_cc_per_rad * MILLILITRE
        speed, drop, own = self.speed_rpm[k] * RPM, self.pressure_mpa[k] * MPA, self.losses()
        passed = displacement * speed
        return (passed / (passed + own.leakage * drop),
                1.0 - (own.coulomb + own.viscous * speed) / (displacement * drop))

    def losses(self) -> Losses:
        """
        Return the losses that both points have  (M7, M8).

        Raises
        ------
        ParameterError
            The points contradict each other, or a negative loss follows from them.

        """
        displacement = self.displacement_cc_per_rad * MILLILITRE
        speeds = [one * RPM for one in self.speed_rpm]
        drops = [one * MPA for one in self.pressure_mpa]
        if max(speeds) < _DIFFERS * min(speeds):
            raise ParameterError(
                f'speed_rpm = {list(self.speed_rpm)} rpm, must differ by a factor of '
                f'{_DIFFERS:g}, to tell Coulomb from viscous friction')
        leakages = [displacement * speed * (1.0 / (PERCENT * share) - 1.0) / drop
                    for speed, share, drop in zip(speeds, self.volumetric_percent, drops)]
        least, most = sorted(leakages)
        if most > _AGREES * least:
            raise ParameterError(
                f'volumetric_percent = {list(self.volumetric_percent)} is a leakage of '
                f'{leakages[0]:.3g} and of {leakages[1]:.3g} m3/s/Pa, must agree within a factor '
                f'of {_AGREES:g}: a laminar leakage is one number')
        torques = [displacement * drop * (1.0 - PERCENT * share)
                   for drop, share in zip(drops, self.mechanical_percent)]
        viscous = (torques[1] - torques[0]) / (speeds[1] - speeds[0])
        coulomb = torques[0] - viscous * speeds[0]
        if viscous < 0.0 or coulomb <= 0.0:
            raise ParameterError(
                f'mechanical_percent = {list(self.mechanical_percent)} is a friction of '
                f'{torques[0]:.3g} Nm at {self.speed_rpm[0]:g} rpm and of {torques[1]:.3g} Nm at '
                f'{self.speed_rpm[1]:g} rpm, must rise with the speed, by less than in proportion')
        weights = [drop * drop for drop in drops]
        leakage = ((leakages[0] * weights[0] + leakages[1] * weights[1])
                   / (weights[0] + weights[1]))
        return Losses(leakage, coulomb, viscous)


def add_losses(drive: Motor, oil: np.record, seals: np.record, moving: np.record) -> None:
    """
    Add the losses of a motor's sheet to `CHAMBERS`, `FRICTION`; take the stops of `MECHANICS`.

    What those have of their own is wear, and the torque that breaks away.
    """
    losses = drive.losses()
    oil.c_li += losses.leakage
    seals.coulomb += losses.coulomb
    seals.stiction += losses.coulomb
    seals.sigma2 += losses.viscous
    moving.k_stop = moving.d_stop = 0.0
