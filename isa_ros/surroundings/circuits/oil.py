"""
The oil of a circuit, the same in all its parts. Neglected: air in it.

Without heat (`isa_ros.surroundings.circuits.heat`) it stays as the section says; with it
compressibility and viscosity follow its temperature by T1 and T2, from the section on. Its
density does not.
"""

from typing import NamedTuple

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import parameter, Parameters


@frozen(kw_only=True)
class CircuitOil(Parameters):
    """The oil of a circuit at its working temperature."""

    bulk_modulus: float = parameter(
        'effective', 'Pa', absent=1.2e9, source='assumed', ge=1e8, le=3e9)
    density: float = parameter(
        'of the oil', 'kg/m3', absent=860.0, source='assumed, mineral oil at 40 celsius',
        ge=500.0, le=1500.0)
    viscosity_mm2_s: float = parameter(
        'kinematic', 'mm2/s', absent=32.0, source='assumed, ISO VG 32 at 40 celsius',
        ge=0.5, le=2000.0)


class OilNow(NamedTuple):
    """The oil of a circuit at a temperature; by default that of the section."""

    bulk_modulus: float
    """Effective, Pa."""
    density: float
    """kg/m3."""
    viscosity_mm2_s: float
    thickness: float = 1.0
    """Viscosity over that of the section."""


def oil_at_sheet(oil: CircuitOil, thickness: float = 1.0, softness: float = 1.0) -> OilNow:
    """Return the oil with its viscosity and its compressibility times these factors."""
    return OilNow(oil.bulk_modulus / softness, oil.density, oil.viscosity_mm2_s * thickness,
                  thickness)
