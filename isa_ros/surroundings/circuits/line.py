"""
A line with resistance, inertance and capacity: a tube or a hose, in lumps.

A line of n lumps has n flows and n - 1 pressures of its own; half a lump of oil stands at each
end, with that of the manifolds. Flow > 0 runs from its inlet to its outlet. Its first resonance
and damping are those of the distributed line with laminar friction: n lumps have the resonance
of n distributed pieces within (pi/2n)^2/24 if one end is shut, (pi/n)^2/24 if both are, and the
damping exactly. Equations C48 and C49.

Neglected: friction that depends on frequency, bends, what the wall's mass and damping do.
"""

import math

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import fault, name, nested, parameter, Parameters
from isa_ros.core.units import LPM, MICRO, MILLI, MPA
from isa_ros.surroundings.circuits.oil import OilNow
from isa_ros.surroundings.circuits.orifice import SMOOTH
import numpy as np

LINE = np.dtype((np.record, [
    ('inertance', 'f8'),            # kg/m4
    ('laminar', 'f8'),              # Pa s/m3
    ('turbulent', 'f8')]))          # Pa (s/m3)^1.75
_BLASIUS = 0.3164                   # f = 0.3164/Re^0.25 of a smooth pipe
_CONTRACTION = 0.62                 # of a jet through a torn wall
_FASTEST_TEAR = 1e5                 # 1/s, of the pressure beside one


@frozen(kw_only=True)
class BoreWall(Parameters):
    """A bore in a block: its wall does not give way."""

    KIND = 'rigid'


@frozen(kw_only=True)
class TubeWall(Parameters):
    """A tube with a thin wall."""

    thickness_mm: float = parameter('of the wall', 'mm', gt=0.0, le=100.0)
    elastic_modulus: float = parameter(
        'of the wall', 'Pa', absent=2.06e11, source='assumed, steel', ge=1e8, le=1e12)


@frozen(kw_only=True)
class HoseWall(Parameters):
    """A hose, by the volumetric expansion of its data sheet."""

    expansion: float = parameter(
        'growth of its volume at a pressure, of its volume', '1', gt=0.0, le=0.5)
    expansion_mpa: float = parameter('pressure of the expansion', 'MPa', gt=0.0, le=70.0)


Wall = BoreWall | TubeWall | HoseWall


@frozen(kw_only=True)
class LinePart(Parameters):
    """A tube or a hose between two manifolds, or to the tank."""

    inlet: str = name('a manifold or the tank')
    outlet: str = name('a manifold or the tank')
    length_m: float = parameter('of the line', 'm', gt=0.0, le=1000.0)
    bore_mm: float = parameter('its inner diameter', 'mm', ge=0.5, le=500.0)
    wall: Wall = nested(BoreWall())
    lumps: float = parameter(
        'number of lumps', '1', absent=8.0, source='derived, resonances within 1 %',
        is_whole=True, ge=1.0, le=64.0)
    burst: float = fault(
        'its wall has torn at the outlet: area of the opening over that of the bore', '1',
        ge=0.0, le=1.0)
    leakage_lpm_per_mpa: float = fault(
        'flow to the outside at its outlet per pressure', 'l/min/MPa', ge=0.0, le=100.0)


def _area(sheet: LinePart) -> float:
    bore = sheet.bore_mm * MILLI
    return 0.25 * math.pi * bore * bore


def capacity(sheet: LinePart, oil: OilNow) -> float:
    """Return V (1/beta + 1/beta_wall) of a whole line, m3/Pa  (C49)."""
    wall = sheet.wall
    soft = 0.0
    if isinstance(wall, TubeWall):
        soft = sheet.bore_mm / (wall.elastic_modulus * wall.thickness_mm)
    elif isinstance(wall, HoseWall):
        soft = wall.expansion / (wall.expansion_mpa * MPA)
    return _area(sheet) * sheet.length_m * (1.0 / oil.bulk_modulus + soft)


def lump_fields(sheet: LinePart, oil: OilNow) -> tuple[float, float, float]:
    """Return the fields of the `LINE` of one lump  (C48)."""
    area, bore, nu = _area(sheet), sheet.bore_mm * MILLI, oil.viscosity_mm2_s * MICRO
    length = sheet.length_m / sheet.lumps
    inertance = oil.density * length / area
    laminar = 32.0 * oil.density * nu * length / (area * bore * bore)
    # dp = f L/d rho v^2/2 with Re = v d/nu: rho L f_0 (nu/d)^0.25/(2 d A^1.75) Q^1.75
    root = math.sqrt(math.sqrt(nu / bore))
    quarter = math.sqrt(math.sqrt(area))
    turbulent = 0.5 * _BLASIUS * oil.density * length * root * quarter / (bore * area * area)
    return inertance, laminar, turbulent


def tear_fields(sheet: LinePart, oil: OilNow, c: float) -> tuple[float, ...]:
    """
    Return the fields of the `ORIFICE` of what leaks to the outside, from a node of ``c``, m3/Pa.

    Of a wide tear on little oil the delta of V5 is such that a step can follow.
    """
    k = _CONTRACTION * sheet.burst * _area(sheet) * math.sqrt(2.0 / oil.density)
    root = 2.0 * k / (c * _FASTEST_TEAR)
    return (k, max(SMOOTH, root * root), sheet.leakage_lpm_per_mpa * LPM / MPA,
            0.0, 1.0, 0.0, 0.0)


@kernel
def friction_drop(flow, line):
    """
    Return the pressure drop of the friction at a flow, Pa  (C48).

    The greater of Hagen and Poiseuille's and of Blasius's for a smooth pipe, which meet at
    Re = 1190: between there and 2300 it is that of a turbulent flow.
    """
    size = abs(flow)
    laminar = line.laminar * size
    root = math.sqrt(size)
    drop = max(laminar, line.turbulent * size * root * math.sqrt(root))
    return drop if flow >= 0.0 else -drop


@kernel
def line_rate(drop, flow, line):
    """Return dQ/dt = (dP - dP_friction)/I, m3/s2  (C48); I > 0 by the ranges."""
    return (drop - friction_drop(flow, line)) / line.inertance
