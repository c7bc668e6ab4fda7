"""
What the oil moves: cylinders with one or two rods, and vane actuators.

Chamber A is the cap side. Telescopic cylinders are not there: their areas change with the stage.
"""

import math
from typing import Any

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.units import MILLI, MILLILITRE
from isa_ros.errors import ParameterError


def rated_pressure() -> Any:
    """Declare the pressure that an actuator is sized for; no equation of the plant has it."""
    return parameter(
        'supply above return pressure that ratings, load cell and gains are sized for', 'MPa',
        absent=20.7, source='paper Table 2', gt=0.0, le=70.0)


@frozen(kw_only=True)
class Cylinder(Parameters):
    """Cylinder with a rod through its head, and a second one through its cap or none."""

    bore_mm: float = parameter('piston diameter', 'mm', gt=0.0, le=500.0)
    rod_mm: float = parameter('rod diameter', 'mm', gt=0.0, le=500.0)
    cap_rod_mm: float = parameter(
        'diameter of a second rod, through the cap; 0: none', 'mm', absent=0.0,
        source='assumed, one rod', ge=0.0, le=500.0)
    stroke_mm: float = parameter('stroke', 'mm', gt=0.0, le=5000.0)
    rated_pressure_mpa: float = rated_pressure()

    def __post_init__(self) -> None:
        """Refuse a rod that leaves no piston area on its side."""
        super().__post_init__()
        for name in ('rod_mm', 'cap_rod_mm'):
            rod = getattr(self, name)
            if rod >= self.bore_mm:
                raise ParameterError(
                    f'{name} = {rod:g} mm, must be < bore_mm = {self.bore_mm:g} mm')

    @property
    def bore_area(self) -> float:
        """Return the area of the bore in m2: of the piston with its rods."""
        bore = self.bore_mm * MILLI
        return math.pi / 4.0 * bore * bore

    @property
    def areas(self) -> tuple[float, float]:
        """Return (A_A, A_B) in m2."""
        bore, rod, cap_rod = (
            one * MILLI for one in (self.bore_mm, self.rod_mm, self.cap_rod_mm))
        return (self.bore_area - math.pi / 4.0 * cap_rod * cap_rod,
                math.pi / 4.0 * (bore * bore - rod * rod))

    @property
    def stroke(self) -> float:
        """Return the stroke in m."""
        return self.stroke_mm * MILLI


@frozen(kw_only=True)
class Vane(Parameters):
    """Rotary vane actuator with equal displacement both ways."""

    displacement_cc_per_rad: float = parameter(
        'displacement D_m', 'cc/rad', ge=1e-3, le=1000.0)
    rotation: float = parameter('angular range L_m', 'rad', gt=0.0, le=6.2)
    rated_pressure_mpa: float = rated_pressure()

    @property
    def areas(self) -> tuple[float, float]:
        """Return (D_m, D_m) in m3/rad."""
        displacement = self.displacement_cc_per_rad * MILLILITRE
        return displacement, displacement

    @property
    def stroke(self) -> float:
        """Return the range in rad."""
        return self.rotation
