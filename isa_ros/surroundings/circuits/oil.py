"""
The oil of a circuit, the same in all its parts. Neglected: air in it, and its temperature.

A tank with a cooler would keep its temperature: what the oil warms up is not simulated.
"""

from dataclasses import dataclass

from isa_ros.core.parameter import parameter, Parameters


@dataclass(frozen=True, kw_only=True)
class Oil(Parameters):
    """The oil of a circuit at its working temperature."""

    bulk_modulus: float = parameter(
        'effective', 'Pa', absent=1.2e9, source='assumed', ge=1e8, le=3e9)
    density: float = parameter(
        'of the oil', 'kg/m3', absent=860.0, source='assumed, mineral oil at 40 celsius',
        ge=500.0, le=1500.0)
    viscosity_mm2_s: float = parameter(
        'kinematic', 'mm2/s', absent=32.0, source='assumed, ISO VG 32 at 40 celsius',
        ge=0.5, le=2000.0)
