"""
Foot on level ground: normal force of Hunt and Crossley, friction with an elastic sole.

The ground is the plane z = 0 and the foot a point. Force > 0 pushes the foot up; the ground
never pulls. Tangential forces act along x and y of the base: a spring and a damper in parallel,
the sole, in series with dry friction. Their deflection is the shear. The law never gives back
more energy than it took, whatever the normal force does. Equations L9-L11 of docs/equations.md.

Neglected: the foot's radius and rolling, uneven ground, and wear of the rubber.
"""

import math

from isa_ros.core.contact import normal_force
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import record
from isa_ros.errors import ParameterError
import numpy as np


SHORTEST_RELAXATION = 1e-4  # s, of c_t/k_t; a Runge-Kutta step is stable up to 2.8 times that


@frozen(kw_only=True)
class Ground(Parameters):
    """The data sheet of foot and ground together."""

    stiffness: float = parameter(
        'k of k d^1.5', 'N/m^1.5', gt=0.0, le=1e9)
    damping: float = parameter(
        "c of the factor 1 + c d' of Hunt and Crossley", 's/m', ge=0.0, le=100.0)
    friction: float = parameter('coefficient of friction', '1', ge=0.01, le=5.0)
    tangential_stiffness: float = parameter(
        'shear stiffness of sole and ground', 'N/m', ge=1e3, le=1e7)
    tangential_damping: float = parameter(
        'shear damping of sole and ground', 'N s/m', ge=1.0, le=1e4)

    def __post_init__(self) -> None:
        """Refuse a sole that springs back faster than the steps of a body can follow."""
        super().__post_init__()
        least = SHORTEST_RELAXATION * self.tangential_stiffness
        if self.tangential_damping < least:
            raise ParameterError(
                f'Ground.tangential_damping = {self.tangential_damping:g} N s/m, must be >= '
                f'{least:g} N s/m, {SHORTEST_RELAXATION:g} s of Ground.tangential_stiffness = '
                f'{self.tangential_stiffness:g} N/m')


GROUND = np.dtype([
    ('stiffness', '<f8'),    # k, N/m^1.5
    ('damping', '<f8'),      # c, s/m
    ('friction', '<f8'),     # mu, 1
    ('tangential_stiffness', '<f8'),   # k_t, N/m
    ('tangential_damping', '<f8'),     # c_t, N s/m
])


def ground_record(sheet: Ground) -> np.record:
    """Return the `GROUND` record of a sheet."""
    return record(
        GROUND, stiffness=sheet.stiffness, damping=sheet.damping, friction=sheet.friction,
        tangential_stiffness=sheet.tangential_stiffness,
        tangential_damping=sheet.tangential_damping)


@kernel
def friction_forces(normal, shear_x, shear_y, v_x, v_y, ground):
    """
    Return -G, cut to the friction cone mu N, with G = k_t z + c_t v  (L10), in N.

    The sole sticks while G is inside the cone and slides with exactly mu N otherwise.
    """
    f_x = -(ground.tangential_stiffness * shear_x + ground.tangential_damping * v_x)
    f_y = -(ground.tangential_stiffness * shear_y + ground.tangential_damping * v_y)
    limit = ground.friction * normal
    size = math.sqrt(f_x * f_x + f_y * f_y)
    if size > limit:
        return f_x * (limit / size), f_y * (limit / size)
    return f_x, f_y


@kernel
def shear_rates(f_x, f_y, shear_x, shear_y, ground):
    """
    Return z' = -(F + k_t z)/c_t  (L11), in m/s, of the shear z under the friction force F.

    Sticking, it is v; sliding, k_t z follows -F with the time constant c_t/k_t; in the air the
    sole springs back with the same. Its declared range keeps c_t > 0.
    """
    k, c = ground.tangential_stiffness, ground.tangential_damping
    return -(f_x + k * shear_x) / c, -(f_y + k * shear_y) / c


@kernel
def contact(height, v_x, v_y, v_z, shear_x, shear_y, ground):
    """Return the force on the foot (x, y, z; N) and the rates of the shear (m/s)."""
    normal = normal_force(height, v_z, ground)
    f_x, f_y = friction_forces(normal, shear_x, shear_y, v_x, v_y, ground)
    rate_x, rate_y = shear_rates(f_x, f_y, shear_x, shear_y, ground)
    return f_x, f_y, normal, rate_x, rate_y
