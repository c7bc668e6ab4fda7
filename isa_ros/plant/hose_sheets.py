"""Data sheets of hoses: their walls, and what they resist; `isa_ros.plant.hose` has the rest."""

import math

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import fault, parameter, Parameters
from isa_ros.core.units import LPM, MILLI, MILLILITRE, MPA
from isa_ros.errors import ParameterError

_LAMINAR_UP_TO = 2300.0     # Reynolds number at which a pipe's laminar flow ends
_BLASIUS = 0.3164           # friction factor times the fourth root of the Reynolds number
_FITTED = (2700.0, 14000.0)     # Reynolds numbers at which a/Re + b is Blasius' factor
_ROUNDED = 5e-3             # a data sheet prints three digits


@frozen(kw_only=True)
class RigidWall(Parameters):
    """A pipe whose wall does not give way."""


@frozen(kw_only=True)
class ExpandingWall(Parameters):
    """A wall by the volumetric expansion of its data sheet."""

    expansion_ml_per_m: float = parameter(
        'growth of its volume at the pressure', 'ml/m', gt=0.0, le=1e3)
    pressure_mpa: float = parameter('at which it is stated', 'MPa', gt=0.0, le=100.0)


@frozen(kw_only=True)
class EffectiveWall(Parameters):
    """A wall by the bulk modulus that oil has in it."""

    bulk_modulus: float = parameter('of oil and wall together', 'Pa', ge=1e6, le=2e9)


@frozen(kw_only=True)
class NoneHoses(Parameters):
    """The valve block is mounted on the cylinder."""


@frozen(kw_only=True)
class LumpedHoses(Parameters):
    """A hose of the same kind in each of both service lines."""

    inner_diameter_mm: float = parameter('of each', 'mm', ge=1.0, le=100.0)
    length_m: float = parameter('of each', 'm', ge=0.05, le=50.0)
    wall: RigidWall | ExpandingWall | EffectiveWall
    viscosity_mm2_per_s: float = parameter(
        'of the oil at plant.oil.temperature_celsius', 'mm2/s', absent=46.0,
        source='assumed, ISO VG 46 at 40 celsius', ge=1.0, le=5e3)
    density: float = parameter(
        'of the oil', 'kg/m3', absent=870.0, source='assumed, mineral oil', ge=500.0, le=2e3)
    rated_lpm: float = parameter(
        'flow at which the drop is stated; 0: a smooth straight hose', 'l/min', absent=0.0,
        source='assumed', ge=0.0, le=1e4)
    rated_drop_mpa: float = parameter(
        'with fittings and bends, at the rated flow', 'MPa', absent=0.0, source='assumed', ge=0.0,
        le=70.0)
    burst_a: float = fault(
        '1: the hose of chamber A has burst', '1', is_whole=True, ge=0.0, le=1.0)
    burst_b: float = fault(
        '1: the hose of chamber B has burst', '1', is_whole=True, ge=0.0, le=1.0)
    leakage_a: float = fault(
        'of the hose of chamber A to the outside', 'm3/s/Pa', ge=0.0, le=1e-11)
    leakage_b: float = fault(
        'of the hose of chamber B to the outside', 'm3/s/Pa', ge=0.0, le=1e-11)

    def __post_init__(self) -> None:
        """Refuse a wall beyond its hose, a drop below a smooth one's, a flow without a drop."""
        super().__post_init__()
        most = self.bore / MILLILITRE
        if isinstance(self.wall, ExpandingWall) and self.wall.expansion_ml_per_m >= most:
            raise ParameterError(
                f'wall.expansion_ml_per_m = {self.wall.expansion_ml_per_m:g} ml/m, must be < '
                f'{most:.4g} ml/m, what inner_diameter_mm = {self.inner_diameter_mm:g} mm holds')
        if (self.rated_lpm == 0.0) != (self.rated_drop_mpa == 0.0):
            raise ParameterError(
                f'rated_lpm = {self.rated_lpm:g} l/min and rated_drop_mpa = '
                f'{self.rated_drop_mpa:g} MPa, must both be 0 or both be stated')
        smooth = smooth_drop(self, self.rated_lpm * LPM)
        if self.rated_drop_mpa * MPA < smooth * (1.0 - _ROUNDED):
            raise ParameterError(
                f'rated_drop_mpa = {self.rated_drop_mpa:g} MPa at rated_lpm = '
                f'{self.rated_lpm:g} l/min, must be >= {smooth / MPA:.3g} MPa, that of a smooth '
                f'straight hose of {self.inner_diameter_mm:g} mm and {self.length_m:g} m')

    @property
    def bore(self) -> float:
        """Return the area of the opening in m2."""
        return math.pi / 4.0 * (self.inner_diameter_mm * MILLI) * (self.inner_diameter_mm * MILLI)

    @property
    def volume(self) -> float:
        """Return the volume of one hose in m3."""
        return self.bore * self.length_m


def _turbulent_factor() -> tuple[float, float]:
    """Return a and b of the friction factor a/Re + b of a turbulent flow  (C41)."""
    low, high = _FITTED
    at_low = _BLASIUS / math.sqrt(math.sqrt(low))
    at_high = _BLASIUS / math.sqrt(math.sqrt(high))
    per = (at_low - at_high) / (1.0 / low - 1.0 / high)
    return per, at_low - per / low


def resistances(sheet: LumpedHoses) -> tuple[float, float, float, float]:
    """Return laminar, linear (Pa s/m3), square (Pa s2/m6) and the critical flow (m3/s)  (C41)."""
    d, nu = sheet.inner_diameter_mm * MILLI, sheet.viscosity_mm2_per_s * MILLI * MILLI
    per_reynolds = sheet.bore * nu / d
    # the drop is factor * l/d * rho/2 (Q/A)^2, and 1/Re = A nu/(d Q)
    head = sheet.length_m / d * 0.5 * sheet.density / (sheet.bore * sheet.bore)
    a, b = _turbulent_factor()
    return (64.0 * per_reynolds * head, a * per_reynolds * head, b * head,
            _LAMINAR_UP_TO * per_reynolds)


def smooth_drop(sheet: LumpedHoses, flow: float) -> float:
    """Return the drop over a smooth straight hose at a flow (m3/s), in Pa  (C41)."""
    laminar, linear, square, critical = resistances(sheet)
    if flow <= critical:
        return laminar * flow
    return linear * flow + square * flow * flow


def per_wall(sheet: LumpedHoses, beta: float) -> float:
    """
    Return 1/K_w of a wall around oil of a bulk modulus ``beta``, in 1/Pa  (C40).

    Raises
    ------
    ParameterError
        The modulus of oil and wall together is larger than that of the oil.

    """
    wall = sheet.wall
    if isinstance(wall, ExpandingWall):
        return wall.expansion_ml_per_m * MILLILITRE / sheet.bore / (wall.pressure_mpa * MPA)
    if isinstance(wall, EffectiveWall):
        if wall.bulk_modulus > beta:
            raise ParameterError(
                f'hoses.wall.bulk_modulus = {wall.bulk_modulus:g} Pa, must be <= {beta:g} Pa, '
                'oil.effective_bulk_modulus: a wall makes oil softer')
        return 1.0 / wall.bulk_modulus - 1.0 / beta
    return 0.0
