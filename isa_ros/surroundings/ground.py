"""
Foot on level ground: normal force of Hunt and Crossley, friction with bristles.

The ground is the plane z = 0 and the foot a point. Force > 0 pushes the foot up; the ground
never pulls. Tangential forces act along x and y of the base. Equations L9-L11 of
docs/equations.md.

Neglected: the foot's radius and rolling, uneven ground, and wear of the rubber.
"""

from dataclasses import dataclass
import math

from isa_ros.core.contact import normal_force
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import record
import numpy as np


@dataclass(frozen=True, kw_only=True)
class Ground(Parameters):
    """The data sheet of foot and ground together."""

    stiffness: float = parameter(
        'k of k d^1.5', 'N/m^1.5', gt=0.0, le=1e9)
    damping: float = parameter(
        "c of the factor 1 + c d' of Hunt and Crossley", 's/m', ge=0.0, le=100.0)
    friction: float = parameter('coefficient of friction', '1', ge=0.01, le=5.0)
    bristle_travel_mm: float = parameter(
        'deflection of the bristles at full friction', 'mm', ge=0.05, le=100.0)
    bristle_damping: float = parameter(
        'friction coefficient per speed of the bristles', 's/m', ge=0.0, le=10.0)
    bristle_relaxation_ms: float = parameter(
        'time constant with which bristles spring back in the air', 'ms', ge=0.5, le=1000.0)


GROUND = np.dtype([
    ('stiffness', '<f8'),    # k, N/m^1.5
    ('damping', '<f8'),      # c, s/m
    ('friction', '<f8'),     # mu, 1
    ('sigma_0', '<f8'),      # mu per bristle deflection, 1/m
    ('sigma_1', '<f8'),      # mu per bristle speed, s/m
    ('relaxation', '<f8'),   # 1/s
])


def ground_record(sheet: Ground) -> np.record:
    """Return the `GROUND` record of a sheet."""
    return record(
        GROUND, stiffness=sheet.stiffness, damping=sheet.damping, friction=sheet.friction,
        sigma_0=sheet.friction / (sheet.bristle_travel_mm * 1e-3), sigma_1=sheet.bristle_damping,
        relaxation=1.0 / (sheet.bristle_relaxation_ms * 1e-3))


@kernel
def bristle_rates(z_x, z_y, v_x, v_y, is_touching, ground):
    """
    Return z' = v - sigma_0 |v| z / mu on the ground, z' = -z / T in the air  (L10), in m/s.

    At steady sliding sigma_0 |z| = mu, whatever the normal force.
    """
    if not is_touching:
        return -ground.relaxation * z_x, -ground.relaxation * z_y
    pull = ground.sigma_0 * math.sqrt(v_x * v_x + v_y * v_y) / ground.friction
    return v_x - pull * z_x, v_y - pull * z_y


@kernel
def friction_forces(normal, z_x, z_y, rate_x, rate_y, ground):
    """
    Return -N (sigma_0 z + sigma_1 z')  (L11), in N, cut to the friction cone mu N.

    The cut affects only the damping's share while the foot begins to slide.
    """
    f_x = -normal * (ground.sigma_0 * z_x + ground.sigma_1 * rate_x)
    f_y = -normal * (ground.sigma_0 * z_y + ground.sigma_1 * rate_y)
    limit = ground.friction * normal
    size = math.sqrt(f_x * f_x + f_y * f_y)
    if size > limit:
        f_x, f_y = f_x * (limit / size), f_y * (limit / size)
    return f_x, f_y


@kernel
def contact(height, v_x, v_y, v_z, z_x, z_y, ground):
    """Return the force on the foot (x, y, z; N) and the bristles' rates (m/s)."""
    normal = normal_force(height, v_z, ground)
    rate_x, rate_y = bristle_rates(z_x, z_y, v_x, v_y, height < 0.0, ground)
    f_x, f_y = friction_forces(normal, z_x, z_y, rate_x, rate_y, ground)
    return f_x, f_y, normal, rate_x, rate_y
