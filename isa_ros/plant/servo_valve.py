"""
Metering of the servo valve: four lands, their flow curve, leakage and lap.

``x > 0`` opens P-A and B-T and extends. Chamber flows are positive INTO the chamber,
``q_p`` positive OUT OF the supply and ``q_t`` positive INTO the return.

The printed valve gains (eq 19) are slopes of figure 5 in l/min per mA, here per metre of
spool (`flow_slope`). Neglected: flow forces and hysteresis.
"""

from dataclasses import dataclass
import math
from typing import NamedTuple

from isa_ros.core.elementary import exp
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import choice, parameter, Parameters
from isa_ros.core.record import record
from isa_ros.core.timebase import FASTEST_RATE
from isa_ros.core.units import LPM, MICRO, MILLI, MPA
import numpy as np


@dataclass(frozen=True, kw_only=True)
class Lap(Parameters):
    """Overlap of each land; negative: underlap."""

    pa_um: float = parameter('land P-A', 'um', ge=-20.0, le=50.0)
    at_um: float = parameter('land A-T', 'um', ge=-20.0, le=50.0)
    bt_um: float = parameter('land B-T', 'um', ge=-20.0, le=50.0)
    pb_um: float = parameter('land P-B', 'um', ge=-20.0, le=50.0)


@dataclass(frozen=True, kw_only=True)
class Valve(Parameters):
    """Parameters of every valve; currents on the series scale of figure 5."""

    spool_gain_mm_per_ma: float = parameter(
        'spool travel per series current, K_spool (eq 9)', 'mm/mA', gt=0.0, le=1.0)
    spool_stop_mm: float = parameter('largest spool travel', 'mm', gt=0.0, le=1.0)
    land_drop_mpa: float = parameter(
        'pressure drop over one land at the stated flows', 'MPa', gt=0.0, le=50.0)
    null_leakage_lpm: float = parameter(
        'leakage q_0 of one closed land at null', 'l/min', ge=0.0, le=2.0)
    leakage_travel_um: float = parameter(
        'travel x_l that halves the leakage of a land', 'um', gt=0.0, le=100.0)
    tare_leakage_lpm: float = parameter(
        'pilot-stage flow at the tare pressure', 'l/min', ge=0.0, le=2.0)
    tare_pressure_mpa: float = parameter(
        'supply above return pressure of the tare leakage', 'MPa', gt=0.0, le=50.0)
    orifice_smoothing_kpa: float = parameter(
        'pressure drop delta below which an orifice is laminar', 'kPa', gt=0.0, le=1000.0)
    slots: str = choice(
        "areas of the lands' slots: matched to the areas of the piston, or all equal",
        'matched', 'equal')
    lap: Lap


@dataclass(frozen=True, kw_only=True)
class DualGainValve(Valve):
    """Ultra-low-leakage valve: a low flow gain about null, a high one beyond."""

    low_gain_lpm_per_ma: float = parameter(
        'flow gain of one land below the dual-gain point', 'l/min/mA', gt=0.0, le=100.0)
    high_gain_lpm_per_ma: float = parameter(
        'flow gain of one land beyond the dual-gain point', 'l/min/mA', gt=0.0, le=100.0)
    dual_gain_point_mm: float = parameter('spool travel x_dg', 'mm', gt=0.0, le=1.0)


@dataclass(frozen=True, kw_only=True)
class HighResponseValve(Valve):
    """High-response valve: one flow gain about null that falls off towards full flow."""

    gain_lpm_per_ma: float = parameter(
        'flow gain of one land up to its knee', 'l/min/mA', gt=0.0, le=100.0)
    knee_ma: float = parameter('series current at which the gain begins to fall', 'mA',
                               gt=0.0, le=50.0)
    remaining_lpm: float = parameter(
        'flow beyond that of the knee, for any current', 'l/min', gt=0.0, le=100.0)


VALVE = np.dtype([
    ('k_spool', 'f8'),      # m/A, series scale
    ('k_low', 'f8'), ('k_high', 'f8'),          # m3/s per m of spool at dp_ref
    ('q_rest', 'f8'),                           # m3/s; 0: straight with k_high beyond x_dg
    ('x_dg', 'f8'), ('x_max', 'f8'),            # m
    ('per_root_drop', 'f8'),                    # 1/sqrt(dp_ref), 1/sqrt(Pa)
    ('q_0', 'f8'), ('x_l', 'f8'),               # m3/s, m
    ('c_tare', 'f8'),                           # m3/s/sqrt(Pa)
    ('delta', 'f8'),                            # Pa
    ('f_pa', 'f8'), ('f_at', 'f8'), ('f_bt', 'f8'), ('f_pb', 'f8'),  # land factors
    ('is_lapped', 'f8'),
    ('lap_pa', 'f8'), ('lap_at', 'f8'), ('lap_bt', 'f8'), ('lap_pb', 'f8'),  # m
])


def flow_slope(gain_lpm_per_ma: float, spool_gain_mm_per_ma: float) -> float:
    """Return the slope of one land's flow curve g, in m3/s per m of spool  (V4)."""
    return (gain_lpm_per_ma * LPM) / (spool_gain_mm_per_ma * MILLI)


def land_factors(area_ratio: float) -> tuple[float, float, float, float]:
    """
    Return the factors of the lands P-A, A-T, B-T, P-B for rho = A_A/A_B  (V8).

    1, sqrt(rho), 1/rho, 1/sqrt(rho): equal speed both ways and no pressure jump when the
    direction changes, as section 2.3 of the paper requires of its unequal slots.
    """
    return 1.0, math.sqrt(area_ratio), 1.0 / area_ratio, 1.0 / math.sqrt(area_ratio)


class _Curve(NamedTuple):
    """The flow curve's fields of a `VALVE`."""

    k_low: float
    k_high: float
    q_rest: float
    x_dg: float


def _curve(sheet: DualGainValve | HighResponseValve) -> _Curve:
    if isinstance(sheet, HighResponseValve):
        return _Curve(
            k_low=flow_slope(sheet.gain_lpm_per_ma, sheet.spool_gain_mm_per_ma), k_high=0.0,
            q_rest=sheet.remaining_lpm * LPM,
            x_dg=sheet.knee_ma * sheet.spool_gain_mm_per_ma * MILLI)
    return _Curve(
        k_low=flow_slope(sheet.low_gain_lpm_per_ma, sheet.spool_gain_mm_per_ma),
        k_high=flow_slope(sheet.high_gain_lpm_per_ma, sheet.spool_gain_mm_per_ma),
        q_rest=0.0, x_dg=sheet.dual_gain_point_mm * MILLI)


def valve_record(sheet: DualGainValve | HighResponseValve, area_ratio: float) -> np.record:
    """Return the `VALVE` record of a sheet on an actuator with A_A/A_B = ``area_ratio``."""
    f_pa, f_at, f_bt, f_pb = land_factors(area_ratio if sheet.slots == 'matched' else 1.0)
    laps = {f'lap_{land}': getattr(sheet.lap, f'{land}_um') * MICRO
            for land in ('pa', 'at', 'bt', 'pb')}
    return record(
        VALVE, k_spool=sheet.spool_gain_mm_per_ma, **_curve(sheet)._asdict(),
        x_max=sheet.spool_stop_mm * MILLI,
        per_root_drop=1.0 / math.sqrt(sheet.land_drop_mpa * MPA),
        q_0=sheet.null_leakage_lpm * LPM, x_l=sheet.leakage_travel_um * MICRO,
        c_tare=sheet.tare_leakage_lpm * LPM / math.sqrt(sheet.tare_pressure_mpa * MPA),
        delta=sheet.orifice_smoothing_kpa * 1e3,
        f_pa=f_pa, f_at=f_at, f_bt=f_bt, f_pb=f_pb,
        is_lapped=float(any(laps.values())), **laps)


def largest_flow_slope(valve: np.record, span: float) -> float:
    """Return dQ/dP of the wide-open valve with ``span`` (Pa) over two lands, in m3/s/Pa."""
    flow = flow_curve(valve.x_max, valve) * math.sqrt(0.5 * span) * valve.per_root_drop
    return float(0.5 * flow / span)


@kernel
def signed_sqrt(dp, delta):
    """
    Return dp / (dp^2 + delta^2)^(1/4)  (V5), in sqrt(Pa).

    Regularised sgn(dp) sqrt(|dp|) with the finite slope 1/sqrt(delta) at dp = 0; 0.25 % low
    at ten times delta.
    """
    return dp / math.sqrt(math.sqrt(dp * dp + delta * delta))


@kernel
def flow_curve(opening, valve):
    """
    Return g, the flow of one open land at the reference drop  (V4), in m3/s.

    Continuous: k_low u up to x_dg; beyond, with slope k_high, or for a high-response valve
    k_low x_dg + q_rest (1 - exp(-(u - x_dg) k_low/q_rest)). ``opening`` u >= 0 in m.
    """
    if opening <= valve.x_dg:
        return valve.k_low * opening
    beyond = opening - valve.x_dg
    if valve.q_rest > 0.0:
        return (valve.k_low * valve.x_dg
                + valve.q_rest * (1.0 - exp(-beyond * valve.k_low / valve.q_rest)))
    return valve.k_low * valve.x_dg + valve.k_high * beyond


@kernel
def leakage(travel, valve):
    """Return q_0 x_l / (x_l + u), a land's leakage at the reference drop  (V6), in m3/s."""
    return valve.q_0 * valve.x_l / (valve.x_l + travel)


@kernel
def land_flow(opening, valve):
    """
    Return g(u) of a land opened by u > 0 and its leakage  (V14), in m3/s at the reference drop.

    ``opening`` is the spool's travel in the land's direction less its lap, in m; closed
    lands, u <= 0, leak only.
    """
    leak = leakage(abs(opening), valve)
    return flow_curve(opening, valve) + leak if opening > 0.0 else leak


@kernel
def conductances(x, valve):
    """
    Return those of the lands P-A, A-T, B-T, P-B at spool ``x``, in m3/s/sqrt(Pa)  (V7).

    Each is f (g + leakage)/sqrt(dP_ref).
    """
    if valve.is_lapped:
        pa, bt = land_flow(x - valve.lap_pa, valve), land_flow(x - valve.lap_bt, valve)
        at, pb = land_flow(-x - valve.lap_at, valve), land_flow(-x - valve.lap_pb, valve)
    else:
        travel = abs(x)
        leak = leakage(travel, valve)
        opened = flow_curve(travel, valve) + leak
        pa = bt = opened if x > 0.0 else leak
        at = pb = opened if x < 0.0 else leak
    scale = valve.per_root_drop
    return (valve.f_pa * (pa * scale), valve.f_at * (at * scale),
            valve.f_bt * (bt * scale), valve.f_pb * (pb * scale))


@kernel
def smoothing(conductance, elastance, delta):
    """
    Return the delta of V5 for the lands of one chamber, in Pa  (V18).

    At no pressure drop a chamber decays at conductance x elastance/sqrt(delta), 1/s; delta grows
    where that would be faster than `FASTEST_RATE`: a wide-open land on little oil.
    """
    root = conductance * elastance / FASTEST_RATE
    return max(delta, root * root)


@kernel
def eased_port_flows(x, p_a, p_b, p_s, p_t, per_a, per_b, valve):
    """
    Return `port_flows` as a step can follow them on chambers of elastances ``per_a``, ``per_b``.

    Elastances in Pa/m3; only near no pressure drop the flows differ from `port_flows`  (V18).
    """
    pa, at, bt, pb = conductances(x, valve)
    delta_a = smoothing(pa + at, per_a, valve.delta)
    delta_b = smoothing(pb + bt, per_b, valve.delta)
    q_pa = pa * signed_sqrt(p_s - p_a, delta_a)
    q_at = at * signed_sqrt(p_a - p_t, delta_a)
    q_bt = bt * signed_sqrt(p_b - p_t, delta_b)
    q_pb = pb * signed_sqrt(p_s - p_b, delta_b)
    q_tare = valve.c_tare * signed_sqrt(p_s - p_t, valve.delta)
    return q_pa - q_at, q_pb - q_bt, q_pa + q_pb + q_tare, q_at + q_bt + q_tare


@kernel
def port_flows(x, p_a, p_b, p_s, p_t, valve):
    """
    Return (q_a, q_b, q_p, q_t) in m3/s at spool ``x`` (m) and pressures in Pa  (V7, V9).

    Equations 11 to 18 of the paper as `Q = (g + leakage) sqrt(dP / dP_ref)` for each of the
    four lands, plus the pilot stage's tare flow from supply to return.
    """
    return eased_port_flows(x, p_a, p_b, p_s, p_t, 0.0, 0.0, valve)
