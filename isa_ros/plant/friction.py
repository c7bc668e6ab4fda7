"""
LuGre friction of the seals.

The force opposes motion: it is subtracted from the hydraulic force. Units N, m (linear)
or Nm, rad (rotary).
"""

from isa_ros.core.elementary import exp
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import record
from isa_ros.core.timebase import FASTEST_RATE
from isa_ros.errors import ParameterError
import numpy as np


LEAST_STICTION = 1e-12  # of the Coulomb force: 1e4 of its roundings, so that g(v) > 0


@frozen(kw_only=True)
class Friction(Parameters):
    """LuGre friction."""

    stiction: float = parameter(
        'force that breaks away', 'N | Nm', changeable=True, gt=0.0, le=1e6)
    coulomb: float = parameter(
        'force at higher speed', 'N | Nm', changeable=True, gt=0.0, le=1e6)
    bristle_stiffness: float = parameter('sigma0', 'N/m | Nm/rad', gt=0.0, le=1e10)
    bristle_damping: float = parameter('sigma1', 'Ns/m | Nms/rad', ge=0.0, le=1e7)
    viscous: float = parameter('sigma2', 'Ns/m | Nms/rad', ge=0.0, le=1e6)
    stribeck_speed: float = parameter('v_s', 'm/s | rad/s', gt=0.0, le=10.0)

    def __post_init__(self) -> None:
        """Refuse a stiction that g(0) of F1 would lose in the rounding of F_c."""
        super().__post_init__()
        if self.stiction < LEAST_STICTION * self.coulomb:
            raise ParameterError(
                f'stiction = {self.stiction:g}, must be >= {LEAST_STICTION:g} coulomb = '
                f'{LEAST_STICTION * self.coulomb:g} (N | Nm)')


FRICTION = np.dtype([
    ('stiction', 'f8'), ('coulomb', 'f8'), ('sigma0', 'f8'), ('sigma1', 'f8'),
    ('sigma2', 'f8'), ('v_s', 'f8')])
FRICTION_STATE = np.dtype([('bristle', 'f8')])


def friction_record(sheet: Friction) -> np.record:
    """Return the `FRICTION` record of a sheet."""
    return record(
        FRICTION, stiction=sheet.stiction, coulomb=sheet.coulomb, sigma0=sheet.bristle_stiffness,
        sigma1=sheet.bristle_damping, sigma2=sheet.viscous, v_s=sheet.stribeck_speed)


@kernel
def stribeck(v, friction):
    """Return g(v) = F_c + (F_s - F_c) exp(-(v/v_s)^2), in N or Nm  (F1)."""
    ratio = v / friction.v_s
    return friction.coulomb + (friction.stiction - friction.coulomb) * exp(-ratio * ratio)


@kernel
def bristle_rate(v, z, friction):
    """
    Return dz/dt = v - sigma0 |v| z / g(v)  (F2), in m/s or rad/s.

    Bristles that would follow faster than a step resolves, do so at `FASTEST_RATE` (F4): the
    force of steady sliding, g(v), is the same.
    """
    pull = friction.sigma0 * abs(v) / stribeck(v, friction)
    rate = v - pull * z
    # the division by itself: else it is done in every step, and the next stage waits for it
    return rate * (1.0 if pull <= FASTEST_RATE else FASTEST_RATE / pull)


@kernel
def friction_force(v, z, z_rate, friction):
    """Return sigma0 z + sigma1 dz/dt + sigma2 v  (F3), in N or Nm."""
    return friction.sigma0 * z + friction.sigma1 * z_rate + friction.sigma2 * v
