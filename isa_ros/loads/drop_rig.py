"""
A weight falling on a rope at the rim of a wheel: the rig of the paper's Figures 16 to 18.

``x`` is the wheel's angle (rad), ``x_0`` its angle at t = 0; the rope pulls the wheel
towards smaller angles, so that it takes a torque > 0 to carry the weight. ``w`` is the
distance the weight has fallen (m, downward). The weight is held by hand until its release, on
the grid of plant steps; then it falls freely through the slack until the rope is taut.
Equations L17-L20 of docs/equations.md.

Neglected: the rope's mass and its swinging, air drag, the hand's reaction before release.
"""

from typing import Any

from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.core.contact import one_sided
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import fault, parameter, Parameters
from isa_ros.core.record import record
from isa_ros.core.timebase import NS_PER_SECOND, PLANT_STEP_NS
from isa_ros.errors import ParameterError
import numpy as np


def external_force() -> Any:
    """Declare a force from outside on a load, which may change during a run."""
    return fault('force from outside on it, > 0 pushes out', 'N | Nm', ge=-2e7, le=2e7)


@frozen(kw_only=True)
class Wheel(Parameters):
    """The paper's load wheel with the rig's two end stops."""

    inertia: float = parameter('wheel', 'kg | kg m2', changeable=True, gt=0.0, le=1e5)
    stop_low: float = parameter('lower end stop of the rig', 'm | rad')
    stop_high: float = parameter('upper end stop of the rig', 'm | rad')
    stop_stiffness: float = parameter('end stops', 'N/m | Nm/rad', gt=0.0, le=1e11)
    stop_damping: float = parameter('end stops', 'Ns/m | Nms/rad', ge=0.0, le=1e9)
    force: float = external_force()

    def __post_init__(self) -> None:
        """Refuse a lower stop that is not below the upper one."""
        super().__post_init__()
        if self.stop_low >= self.stop_high:
            raise ParameterError(
                f'stop_low = {self.stop_low:g} m | rad, must be < stop_high = '
                f'{self.stop_high:g} m | rad')


@frozen(kw_only=True)
class DropRig(Wheel):
    """The load wheel with a weight on a slack rope at its rim."""

    radius: float = parameter('of the rim the rope is wound on', 'm/m | m/rad', gt=0.0, le=10.0)
    rope_stiffness: float = parameter('rope, pulling only', 'N/m', gt=0.0, le=1e8)
    rope_damping: float = parameter('rope, while taut', 'Ns/m', ge=0.0, le=1e5)
    slack: float = parameter('free fall until the rope is taut', 'm', ge=0.0, le=10.0)
    weight_kg: float = parameter('falling weight', 'kg', ge=0.01, le=1e3)
    release_s: float = parameter('the weight is held until then', 's', ge=0.0, le=1e6)

    def __post_init__(self) -> None:
        """Refuse a release between two plant steps."""
        super().__post_init__()
        steps = self.release_s * NS_PER_SECOND / PLANT_STEP_NS
        if abs(steps - round(steps)) * PLANT_STEP_NS > 1.0:  # 1 ns, above a double's rounding
            raise ParameterError(
                f'DropRig.release_s = {self.release_s:.9g} s, must be a multiple of the plant '
                f'step {PLANT_STEP_NS / 1e6:g} ms')


ROPE = np.dtype([
    ('radius', 'f8'),         # m/rad
    ('stiffness', 'f8'),      # N/m; zero: no rope
    ('damping', 'f8'),        # Ns/m
    ('slack', 'f8'),          # m
    ('mass', 'f8'),           # of the weight, kg
    ('gravity', 'f8'),        # m/s2
    ('release_step', 'i8'),   # plant steps since t = 0
])
WEIGHT_STATE = np.dtype([
    ('fall', 'f8'),           # w, m
    ('velocity', 'f8'),       # m/s
    ('is_released', 'f8'),    # 1.0 from the release step on
])


def rope_record(sheet: DropRig) -> np.record:
    """Return the `ROPE` record of a sheet."""
    return record(
        ROPE, radius=sheet.radius, stiffness=sheet.rope_stiffness, damping=sheet.rope_damping,
        slack=sheet.slack, mass=sheet.weight_kg, gravity=STANDARD_GRAVITY,
        release_step=round(sheet.release_s * NS_PER_SECOND / PLANT_STEP_NS))


@kernel
def rope_stretch(turn, fall, rope):
    """Return e = w + R (x - x_0) - slack  (L17), in m; < 0 while the rope is slack."""
    return fall + rope.radius * turn - rope.slack


@kernel
def rope_tension(turn, speed, weight, rope):
    """Return T = max(0, k e + c e') while e > 0, else 0  (L18), in N: a rope never pushes."""
    return one_sided(
        rope_stretch(turn, weight.fall, rope), weight.velocity + rope.radius * speed,
        rope.stiffness, rope.damping)


@kernel
def weight_acceleration(tension, weight, rope):
    """Return w'' = g - T/m once released, 0 while held  (L19), in m/s2; m > 0 declared."""
    return weight.is_released * (rope.gravity - tension / rope.mass)


@kernel
def weight_rates(turn, speed, weight, rope, rates):
    """
    Write the derivative of one `WEIGHT_STATE`; return the torque -R T on the wheel  (L20).

    ``turn`` is x - x_0. The rate of ``is_released`` is always zero and is not written.
    """
    tension = rope_tension(turn, speed, weight, rope)
    rates.fall = weight.velocity
    rates.velocity = weight_acceleration(tension, weight, rope)
    return -rope.radius * tension
