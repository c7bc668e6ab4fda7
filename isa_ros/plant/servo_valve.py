"""
Dual-gain servo valve: closed spool loop and metering flows.

``x > 0`` opens P-A and B-T and extends. Chamber flows are positive INTO the chamber,
``q_p`` positive OUT OF the supply and ``q_t`` positive INTO the return.

Equation 8 of the paper IS the closed spool loop: never nest it in another one.
The printed valve gains (eq 19) are slopes of figure 5 in l/min per mA, here per metre of
spool (`flow_slope`). Neglected: flow forces, hysteresis, null bias and land lap.
"""

from dataclasses import dataclass
import math

from isa_ros.kernel import kernel
from isa_ros.parameter import parameter, Parameters
from isa_ros.plant.units import LPM, MILLI, MPA
import numpy as np


@dataclass(frozen=True, kw_only=True)
class ServoValve(Parameters):
    """Ultra-low-leakage valve; currents on the series scale of figure 5."""

    spool_gain_mm_per_ma: float = parameter(
        'spool travel per series current, K_spool (eq 9)', 'mm/mA', gt=0.0, le=1.0)
    low_gain_lpm_per_ma: float = parameter(
        'flow gain of one land below the dual-gain point', 'l/min/mA', gt=0.0, le=100.0)
    high_gain_lpm_per_ma: float = parameter(
        'flow gain of one land beyond the dual-gain point', 'l/min/mA', gt=0.0, le=100.0)
    dual_gain_point_mm: float = parameter('spool travel x_dg', 'mm', gt=0.0, le=1.0)
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
    loop_gain_per_s: float = parameter('K_loop of equation 8', '1/s', gt=0.0, le=1.0e4)
    natural_frequency_rad_per_s: float = parameter(
        'w_n of equation 8', 'rad/s', gt=0.0, le=2.0e4)
    damping_ratio: float = parameter('zeta of equation 8', '1', gt=0.0, le=5.0)


VALVE = np.dtype([
    ('k_spool', 'f8'),      # m/A, series scale
    ('k_low', 'f8'), ('k_high', 'f8'),          # m3/s per m of spool at dp_ref
    ('x_dg', 'f8'), ('x_max', 'f8'),            # m
    ('per_root_drop', 'f8'),                    # 1/sqrt(dp_ref), 1/sqrt(Pa)
    ('q_0', 'f8'), ('x_l', 'f8'),               # m3/s, m
    ('c_tare', 'f8'),                           # m3/s/sqrt(Pa)
    ('delta', 'f8'),                            # Pa
    ('k_loop', 'f8'), ('w_n', 'f8'), ('zeta', 'f8'),
    ('f_pa', 'f8'), ('f_at', 'f8'), ('f_bt', 'f8'), ('f_pb', 'f8'),  # land factors
])
VALVE_STATE = np.dtype([('spool', 'f8'), ('velocity', 'f8'), ('acceleration', 'f8')])


def flow_slope(gain_lpm_per_ma: float, spool_gain_mm_per_ma: float) -> float:
    """Return the slope of one land's flow curve g, in m3/s per m of spool  (V4)."""
    return (gain_lpm_per_ma * LPM) / (spool_gain_mm_per_ma * MILLI)


def land_factors(area_ratio: float) -> tuple[float, float, float, float]:
    """
    Return the factors of the lands P-A, A-T, B-T, P-B for rho = A_A/A_B  (V8).

    1, sqrt(rho), 1/rho, 1/sqrt(rho): equal speed both ways and no pressure jump when the
    direction changes, which is what section 2.3 of the paper asks of its unequal slots.
    """
    return 1.0, math.sqrt(area_ratio), 1.0 / area_ratio, 1.0 / math.sqrt(area_ratio)


def valve_record(sheet: ServoValve, area_ratio: float) -> tuple[float, ...]:
    """Return the `VALVE` record of a sheet on an actuator with A_A/A_B = ``area_ratio``."""
    return (
        sheet.spool_gain_mm_per_ma,
        flow_slope(sheet.low_gain_lpm_per_ma, sheet.spool_gain_mm_per_ma),
        flow_slope(sheet.high_gain_lpm_per_ma, sheet.spool_gain_mm_per_ma),
        sheet.dual_gain_point_mm * MILLI,
        sheet.spool_stop_mm * MILLI,
        1.0 / math.sqrt(sheet.land_drop_mpa * MPA),
        sheet.null_leakage_lpm * LPM,
        sheet.leakage_travel_um * 1e-6,
        sheet.tare_leakage_lpm * LPM / math.sqrt(sheet.tare_pressure_mpa * MPA),
        sheet.orifice_smoothing_kpa * 1e3,
        sheet.loop_gain_per_s,
        sheet.natural_frequency_rad_per_s,
        sheet.damping_ratio,
        *land_factors(area_ratio),
    )


def largest_flow_slope(valve: np.record, span: float) -> float:
    """Return dQ/dP of the wide-open valve with ``span`` (Pa) over two lands, in m3/s/Pa."""
    flow = flow_curve(valve.x_max, valve) * math.sqrt(0.5 * span) * valve.per_root_drop
    return float(0.5 * flow / span)


@kernel
def spool_reference(current, parallel, valve):
    """Return K_spool i / n of an amplifier current (A) over ``parallel`` coils  (V2), in m."""
    return valve.k_spool * current / parallel


@kernel
def spool_jerk(reference, spool, valve):
    """
    Return w_n^2 K_loop (x_r - x) - w_n^2 x' - 2 zeta w_n x''  (V3), in m/s3.

    Equation 8 of the paper in the time domain; ``spool`` is a `VALVE_STATE` record.
    """
    w_n = valve.w_n
    return (w_n * w_n * (valve.k_loop * (reference - spool.spool) - spool.velocity)
            - 2.0 * valve.zeta * w_n * spool.acceleration)


@kernel
def spool_acceleration(reference, spool, velocity, w_n, zeta):
    """Return w_n^2 (x_r - x) - 2 zeta w_n x'  (V10, equation 7 of the paper), in m/s2."""
    return w_n * w_n * (reference - spool) - 2.0 * zeta * w_n * velocity


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

    Continuous and piecewise linear: k_low u up to x_dg, with slope k_high beyond.
    ``opening`` u >= 0 in m.
    """
    if opening <= valve.x_dg:
        return valve.k_low * opening
    return valve.k_low * valve.x_dg + valve.k_high * (opening - valve.x_dg)


@kernel
def leakage(travel, valve):
    """Return q_0 x_l / (x_l + u), what every land leaks at the reference drop  (V6), in m3/s."""
    return valve.q_0 * valve.x_l / (valve.x_l + travel)


@kernel
def port_flows(x, p_a, p_b, p_s, p_t, valve):
    """
    Return (q_a, q_b, q_p, q_t) in m3/s at spool ``x`` (m) and pressures in Pa  (V7, V9).

    Equations 11 to 18 of the paper as `Q = (g + leakage) sqrt(dP / dP_ref)` for each of the
    four lands, plus the pilot stage's tare flow from supply to return.
    """
    travel = abs(x)
    leak = leakage(travel, valve)
    opened = flow_curve(travel, valve) + leak
    extending = (opened if x > 0.0 else leak) * valve.per_root_drop
    retracting = (opened if x < 0.0 else leak) * valve.per_root_drop
    q_pa = valve.f_pa * extending * signed_sqrt(p_s - p_a, valve.delta)
    q_at = valve.f_at * retracting * signed_sqrt(p_a - p_t, valve.delta)
    q_bt = valve.f_bt * extending * signed_sqrt(p_b - p_t, valve.delta)
    q_pb = valve.f_pb * retracting * signed_sqrt(p_s - p_b, valve.delta)
    q_tare = valve.c_tare * signed_sqrt(p_s - p_t, valve.delta)
    return q_pa - q_at, q_pb - q_bt, q_pa + q_pb + q_tare, q_at + q_bt + q_tare
