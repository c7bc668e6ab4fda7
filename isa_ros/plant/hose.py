"""
Hoses between the valve block and the cylinder: oil, wall and resistance of each line.

A hose has one pressure, that at the valve block, and its resistance at its other end. Its wall
gives way: it holds as much as a larger volume of rigid wall, V (1 + beta/K_w). The state is the
`lack` of that volume (C11, C40), so that oil is neither made nor lost, and boils as in a chamber.
Flows are positive TOWARDS the chamber. Neglected: the inertia of the oil, so that no wave shows
(the first is at a quarter of the speed of sound over the length: 100 Hz in 2.5 m), hysteresis of
the wall, heat, and the air that enters through a burst below the pressure of the atmosphere.
"""

import math

from isa_ros.core.kernel import kernel
from isa_ros.core.orifice import signed_sqrt
from isa_ros.core.record import record
from isa_ros.core.timebase import FASTEST_RATE
from isa_ros.core.units import LPM, MPA
from isa_ros.plant.cavitation import contents, denser
from isa_ros.plant.hose_sheets import LumpedHoses, NoneHoses, per_wall, resistances, smooth_drop
from isa_ros.plant.servo_valve import smoothing
import numpy as np

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

_CONTRACTION = 0.6          # discharge coefficient of a sharp opening
_EXCHANGE_RATE = 0.5 * FASTEST_RATE     # 1/s, as lands and relief valves have up to FASTEST_RATE
_BURST_SHARE = 4.0          # a burst hose empties no faster than a quarter of FASTEST_RATE


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
    laminar, linear, square, critical = resistances(sheet)
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
