"""
Hoses between the valve block and the cylinder: oil, wall and resistance of each line.

A hose has one pressure, that at the valve block, and its resistance at its other end. Its wall
gives way: it holds as much as a larger volume of rigid wall, V (1 + beta/K_w). The state is the
`lack` of that volume (C11, C40), so that oil is neither made nor lost, and boils as in a chamber.
Flows are positive TOWARDS the chamber. Neglected: the inertia of the oil, so that no wave shows
(the first is at a quarter of the speed of sound over the length: 100 Hz in 2.5 m), hysteresis of
the wall, heat, and the air that enters through a burst below the pressure of the atmosphere.
"""

from dataclasses import dataclass
import math

from isa_ros.core.kernel import kernel
from isa_ros.core.orifice import signed_sqrt
from isa_ros.core.parameter import fault, parameter, Parameters
from isa_ros.core.record import record
from isa_ros.core.timebase import FASTEST_RATE
from isa_ros.core.units import LPM, MILLI, MILLILITRE, MPA
from isa_ros.errors import ParameterError
from isa_ros.plant.cavitation import contents, denser
from isa_ros.plant.servo_valve import smoothing
import numpy as np


@dataclass(frozen=True, kw_only=True)
class RigidWall(Parameters):
    """A pipe whose wall does not give way."""


@dataclass(frozen=True, kw_only=True)
class ExpandingWall(Parameters):
    """A wall by the volumetric expansion of its data sheet."""

    expansion_ml_per_m: float = parameter(
        'growth of its volume at the pressure', 'ml/m', gt=0.0, le=1e3)
    pressure_mpa: float = parameter('at which it is stated', 'MPa', gt=0.0, le=100.0)


@dataclass(frozen=True, kw_only=True)
class EffectiveWall(Parameters):
    """A wall by the bulk modulus that oil has in it."""

    bulk_modulus: float = parameter('of oil and wall together', 'Pa', ge=1e6, le=2e9)


@dataclass(frozen=True, kw_only=True)
class NoneHoses(Parameters):
    """The valve block is mounted on the cylinder."""


@dataclass(frozen=True, kw_only=True)
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


HOSES = np.dtype([
    ('is_on', 'f8'),                            # 1: there are hoses
    ('volume', 'f8'), ('per_wall', 'f8'),       # of each, m3; 1/K_w, 1/Pa
    ('beta', 'f8'), ('p_air', 'f8'), ('p_vapour', 'f8'), ('air', 'f8'),     # as in `CHAMBERS`
    ('density_unit', 'f8'),     # that of `denser` in a chamber over that in a hose  (C40)
    ('laminar', 'f8'), ('linear', 'f8'),        # Pa s/m3
    ('square', 'f8'), ('fittings', 'f8'),       # Pa s2/m6
    ('critical', 'f8'),                         # flow at which a laminar flow ends, m3/s
    ('thicker', 'f8'),                          # viscosity over that of the sheet
    ('k_burst_a', 'f8'), ('k_burst_b', 'f8'),   # m3/s/sqrt(Pa)
    ('c_out_a', 'f8'), ('c_out_b', 'f8')])      # m3/s/Pa
LINES_STATE = np.dtype([
    ('lack_a', 'f8'), ('lack_b', 'f8'),         # of the hoses, m3  (C40)
    ('lift_a', 'f8'), ('lift_b', 'f8')])        # of the load-holding valves: 0 shut, 1 open

_LAMINAR_UP_TO = 2300.0     # Reynolds number at which a pipe's laminar flow ends
_BLASIUS = 0.3164           # friction factor times the fourth root of the Reynolds number
_FITTED = (2700.0, 14000.0)     # Reynolds numbers at which a/Re + b is Blasius' factor
_CONTRACTION = 0.6          # discharge coefficient of a sharp opening
_ROUNDED = 5e-3             # a data sheet prints three digits
_EXCHANGE_RATE = 0.5 * FASTEST_RATE     # 1/s, as lands and relief valves have up to FASTEST_RATE
_BURST_SHARE = 4.0          # a burst hose empties no faster than a quarter of FASTEST_RATE


def _turbulent_factor() -> tuple[float, float]:
    """Return a and b of the friction factor a/Re + b of a turbulent flow  (C41)."""
    low, high = _FITTED
    at_low = _BLASIUS / math.sqrt(math.sqrt(low))
    at_high = _BLASIUS / math.sqrt(math.sqrt(high))
    per = (at_low - at_high) / (1.0 / low - 1.0 / high)
    return per, at_low - per / low


def _resistances(sheet: LumpedHoses) -> tuple[float, float, float, float]:
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
    laminar, linear, square, critical = _resistances(sheet)
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


def hoses_record(sheet: NoneHoses | LumpedHoses, oil: np.record) -> np.record:
    """
    Return the `HOSES` record of a sheet; ``oil`` is the `CHAMBERS` record.

    The oil's air is that of the hose itself, not of the larger volume that stands for its wall;
    the oil is as dense in both at the pressure of the atmosphere.
    """
    if isinstance(sheet, NoneHoses):
        return record(HOSES, **dict.fromkeys(HOSES.names or (), 0.0))
    give = per_wall(sheet, oil.beta)
    larger = 1.0 + oil.beta * give
    laminar, linear, square, critical = _resistances(sheet)
    flow = sheet.rated_lpm * LPM
    rest = max(0.0, sheet.rated_drop_mpa * MPA - smooth_drop(sheet, flow))
    k_burst = _CONTRACTION * sheet.bore * math.sqrt(2.0 / sheet.density)
    own = record(
        HOSES, is_on=1.0, volume=sheet.volume, per_wall=give, beta=oil.beta,
        p_air=oil.p_air * larger, p_vapour=oil.p_vapour, air=oil.air / larger, density_unit=0.0,
        laminar=laminar, linear=linear, square=square,
        fittings=rest / (flow * flow) if flow > 0.0 else 0.0, critical=critical, thicker=1.0,
        k_burst_a=sheet.burst_a * k_burst, k_burst_b=sheet.burst_b * k_burst,
        c_out_a=sheet.leakage_a, c_out_b=sheet.leakage_b)
    own.density_unit = (1.0 + denser(0.0, own)) / (1.0 + denser(0.0, oil))
    return own


def largest_resistance(hoses: np.record, flow: float, thicker: float) -> float:
    """
    Return drop over flow (Pa s/m3) at a flow in m3/s, the largest up to there  (C41).

    ``thicker`` is the oil's viscosity over that of the sheet.
    """
    smooth = (hoses.laminar * thicker if flow <= hoses.critical * thicker
              else hoses.linear * thicker + hoses.square * flow)
    return float(smooth + hoses.fittings * flow)


@kernel
def soft_volume(hoses):
    """Return V (1 + beta/K_w), the volume of oil that is as soft as a hose, in m3  (C40)."""
    return hoses.volume * (1.0 + hoses.beta * hoses.per_wall)


@kernel
def hose_contents(lacking, near, hoses):
    """Return pressure, elastance (Pa/m3) and `denser` of a hose; ``near`` a pressure near it."""
    return contents(lacking, soft_volume(hoses), near, hoses)


@kernel
def resistance_at(drop, linear, square):
    """Return sqrt(a^2 + 4 b dP), the slope d(dP)/dQ of dP = a Q + b Q^2, in Pa s/m3."""
    return math.sqrt(linear * linear + 4.0 * square * drop)


@kernel
def flow_at(drop, linear, square):
    """Return Q of dP = a Q + b Q^2, in m3/s; ``drop`` >= 0, ``linear`` > 0."""
    return 2.0 * drop / (linear + resistance_at(drop, linear, square))


@kernel
def series_flow(drop, square, lag, hoses):
    """
    Return the flow through a hose and an orifice in series at a drop over both  (C41), in m3/s.

    ``square`` is 1/K^2 of the orifice (Pa s2/m6), ``lag`` a further linear resistance (Pa s/m3).
    Laminar up to the critical flow; turbulent where that is more than it; between both the
    critical flow itself.
    """
    size, thicker, rest = abs(drop), hoses.thicker, hoses.fittings + square
    slow = flow_at(size, hoses.laminar * thicker + lag, rest)
    fast = flow_at(size, hoses.linear * thicker + lag, hoses.square + rest)
    flow = min(slow, max(fast, hoses.critical * thicker))
    return flow if drop > 0.0 else -flow


@kernel
def series_slope(drop, square, hoses):
    """Return d(dP)/dQ of `series_flow` without a lag, Pa s/m3; 0 where the flow does not rise."""
    size, thicker, rest = abs(drop), hoses.thicker, hoses.fittings + square
    laminar, critical = hoses.laminar * thicker, hoses.critical * thicker
    if flow_at(size, laminar, rest) <= critical:
        return resistance_at(size, laminar, rest)
    linear = hoses.linear * thicker
    if flow_at(size, linear, hoses.square + rest) <= critical:
        return 0.0
    return resistance_at(size, linear, hoses.square + rest)


@kernel
def hose_flow(drop, square, even, elastance, hoses):
    """
    Return the flow from a hose to its chamber as a step can follow it  (C42), in m3/s.

    Both have ``elastance`` together (Pa/m3), and at the flow ``even`` (m3/s) the drop would not
    change. A drop that decays faster than half of `FASTEST_RATE` has that rate: the flow is that
    of C41 at the drop that it leaves after this time, the same at rest, and no oil is lost.
    """
    slope = series_slope(drop, square, hoses)
    lag = max(0.0, elastance / _EXCHANGE_RATE - slope) if slope > 0.0 else 0.0
    return series_flow(drop + lag * even, square, lag, hoses)


@kernel
def outward(p, elastance, c_out, k_burst):
    """Return the flow of a leaking or burst hose to the outside, in m3/s  (C43)."""
    flow = c_out * max(0.0, p)
    if k_burst > 0.0:
        flow += k_burst * signed_sqrt(
            max(0.0, p), smoothing(k_burst, _BURST_SHARE * elastance, 1.0))
    return flow


@kernel
def warm_hoses(thicker, beta, hoses):
    """Let oil of another viscosity, over that of the sheet, and modulus (Pa) act  (T3)."""
    hoses.thicker, hoses.beta = thicker, beta
