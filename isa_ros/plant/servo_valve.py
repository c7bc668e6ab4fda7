"""
Metering of the servo valve: four lands, their flow curve, leakage and lap.

``x > 0`` opens P-A and B-T and extends. Chamber flows are positive INTO the chamber,
``q_p`` positive OUT OF the supply and ``q_t`` positive INTO the return.

The printed valve gains (eq 19) are slopes of figure 5 in l/min per mA, here per metre of
spool (`flow_slope`). Neglected: flow forces and hysteresis.
"""

import math
from typing import NamedTuple

from isa_ros.core.elementary import exp
from isa_ros.core.kernel import kernel
from isa_ros.core.piecewise import LINES, lines_record, y_on_lines
from isa_ros.core.record import record
from isa_ros.core.timebase import FASTEST_RATE
from isa_ros.core.units import LPM, MICRO, MILLI, MPA
from isa_ros.plant.valve_sheets import DataSheetValve, DualGainValve, HighResponseValve
import numpy as np

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
    ('has_points', 'f8'),   # 1: flow and leakage are the two curves below
    ('flow', LINES), ('leak', LINES),           # m3/s at dp_ref over m of spool
    ('leak_factor', 'f8'),  # of the curve above  (T3)
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


class Lands(NamedTuple):
    """Factors of the four lands  (V8)."""

    pa: float
    at: float
    bt: float
    pb: float


class _Metering(NamedTuple):
    """The fields of a `VALVE` that depend on its kind."""

    k_low: float
    k_high: float
    q_rest: float
    x_dg: float
    per_root_drop: float
    q_0: float
    x_l: float
    c_tare: float
    has_points: float
    flow: np.record
    leak: np.record


def _drawn(sheet: DualGainValve | HighResponseValve) -> _Metering:
    """Return the metering of a valve whose curves are those of figures 5 and 6."""
    if isinstance(sheet, HighResponseValve):
        k_low, k_high = flow_slope(sheet.gain_lpm_per_ma, sheet.spool_gain_mm_per_ma), 0.0
        q_rest = sheet.remaining_lpm * LPM
        x_dg = sheet.knee_ma * sheet.spool_gain_mm_per_ma * MILLI
    else:
        k_low = flow_slope(sheet.low_gain_lpm_per_ma, sheet.spool_gain_mm_per_ma)
        k_high = flow_slope(sheet.high_gain_lpm_per_ma, sheet.spool_gain_mm_per_ma)
        q_rest, x_dg = 0.0, sheet.dual_gain_point_mm * MILLI
    none = lines_record([0.0], [0.0])
    return _Metering(
        k_low, k_high, q_rest, x_dg, 1.0 / math.sqrt(sheet.land_drop_mpa * MPA),
        sheet.null_leakage_lpm * LPM, sheet.leakage_travel_um * MICRO,
        sheet.tare_leakage_lpm * LPM / math.sqrt(sheet.tare_pressure_mpa * MPA),
        0.0, none, none)


def land_leakage(flow: float, total: float, lands: Lands, root_drops: float) -> float:
    """
    Return the leakage l of a land that gives a valve's ``total`` with both ports shut  (V16).

    In m3/s at dp_ref. P-A and A-T are in series, and so are P-B and B-T: with a = f (g + l) of
    the open land, b = f l of the closed one, each pair passes a b/sqrt(a^2 + b^2) times
    ``root_drops``, sqrt((P_S - P_T)/dp_ref). ``flow`` is g; the open lands are P-A and B-T.
    """
    pairs = (lands.pa, lands.at), (lands.bt, lands.pb)

    def passed(leak: float, opened: float) -> float:
        flow = 0.0
        for f, g in pairs:
            a, b = f * opened, g * leak
            flow += a * b / math.sqrt(a * a + b * b)
        return root_drops * flow

    low, high = 0.0, total / passed(1.0, 1.0)  # a land that is not open needs the most
    while low < 0.5 * (low + high) < high:
        middle = 0.5 * (low + high)
        if passed(middle, flow + middle) < total:
            low = middle
        else:
            high = middle
    return high


def _stated(sheet: DataSheetValve, lands: Lands) -> _Metering:
    """Return the metering of a valve with points of its data sheet  (V15, V16)."""
    k_spool, land_drop = sheet.spool_gain_mm_per_ma, 0.5 * sheet.rated_drop_mpa * MPA
    flow = lines_record([i * k_spool * MILLI for i in sheet.flow.currents_ma],
                        [q * LPM for q in sheet.flow.flows_lpm])
    at, own = sheet.leakage, sheet.leakage.pressure_mpa * MPA
    travels = [i * k_spool * MILLI for i in at.current_ma]
    leak = lines_record(travels, [
        land_leakage(y_on_lines(x, flow), (total - at.tare_lpm) * LPM, lands,
                     math.sqrt(own / land_drop))
        for x, total in zip(travels, at.total_lpm)])
    last = len(sheet.flow.currents_ma) - 1
    return _Metering(
        k_low=flow.slope[0], k_high=flow.slope[last - 1], q_rest=0.0, x_dg=flow.x[1],
        per_root_drop=1.0 / math.sqrt(land_drop), q_0=leak.y[0], x_l=flow.x[last],
        c_tare=at.tare_lpm * LPM / math.sqrt(own), has_points=1.0, flow=flow, leak=leak)


def valve_record(
        sheet: DualGainValve | HighResponseValve | DataSheetValve,
        area_ratio: float) -> np.record:
    """Return the `VALVE` record of a sheet on an actuator with A_A/A_B = ``area_ratio``."""
    lands = Lands(*land_factors(area_ratio if sheet.slots == 'matched' else 1.0))
    metering = _stated(sheet, lands) if isinstance(sheet, DataSheetValve) else _drawn(sheet)
    laps = {f'lap_{land}': getattr(sheet.lap, f'{land}_um') * MICRO for land in Lands._fields}
    return record(
        VALVE, k_spool=sheet.spool_gain_mm_per_ma, **metering._asdict(),
        x_max=sheet.spool_stop_mm * MILLI, delta=sheet.orifice_smoothing_kpa * 1e3,
        f_pa=lands.pa, f_at=lands.at, f_bt=lands.bt, f_pb=lands.pb,
        is_lapped=float(any(laps.values())), leak_factor=1.0, **laps)


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
    k_low x_dg + q_rest (1 - exp(-(u - x_dg) k_low/q_rest)). Of a data sheet: straight lines
    between its points  (V15). ``opening`` u >= 0 in m.
    """
    if valve.has_points > 0.0:
        return y_on_lines(opening, valve.flow)
    if opening <= valve.x_dg:
        return valve.k_low * opening
    beyond = opening - valve.x_dg
    if valve.q_rest > 0.0:
        return (valve.k_low * valve.x_dg
                + valve.q_rest * (1.0 - exp(-beyond * valve.k_low / valve.q_rest)))
    return valve.k_low * valve.x_dg + valve.k_high * beyond


@kernel
def leakage(travel, valve):
    """
    Return q_0 x_l / (x_l + u), a land's leakage at the reference drop  (V6), in m3/s.

    Of a data sheet: straight lines between the leakages of V16, times a factor  (T3).
    """
    if valve.has_points > 0.0:
        return valve.leak_factor * y_on_lines(travel, valve.leak)
    return valve.q_0 * valve.x_l / (valve.x_l + travel)


@kernel
def land_flow(opening, valve):
    """
    Return g(u) of a land opened by u > 0 plus its leakage, and the leakage  (V14).

    In m3/s at the reference drop. ``opening`` is the spool's travel in the land's direction
    less its lap, in m; closed lands, u <= 0, leak only.
    """
    leak = leakage(abs(opening), valve)
    return (flow_curve(opening, valve) + leak if opening > 0.0 else leak), leak


@kernel
def conductances(x, valve):
    """
    Return those of the lands P-A, A-T, B-T, P-B at spool ``x``, in m3/s/sqrt(Pa)  (V7).

    Each is f (g + leakage)/sqrt(dP_ref). The second four are those of the leakage alone.
    """
    if valve.is_lapped:
        pa, leak_pa = land_flow(x - valve.lap_pa, valve)
        bt, leak_bt = land_flow(x - valve.lap_bt, valve)
        at, leak_at = land_flow(-x - valve.lap_at, valve)
        pb, leak_pb = land_flow(-x - valve.lap_pb, valve)
    else:
        travel = abs(x)
        leak = leakage(travel, valve)
        opened = flow_curve(travel, valve) + leak
        leak_pa = leak_at = leak_bt = leak_pb = leak
        pa = bt = opened if x > 0.0 else leak
        at = pb = opened if x < 0.0 else leak
    scale = valve.per_root_drop
    return ((valve.f_pa * (pa * scale), valve.f_at * (at * scale),
             valve.f_bt * (bt * scale), valve.f_pb * (pb * scale)),
            (valve.f_pa * (leak_pa * scale), valve.f_at * (leak_at * scale),
             valve.f_bt * (leak_bt * scale), valve.f_pb * (leak_pb * scale)))


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
def root_drops(opened, p_a, p_b, p_s, p_t, per_a, per_b, valve):
    """
    Return S(dP) of the lands P-A, A-T, B-T, P-B as a step can follow it  (V5, V18), in sqrt(Pa).

    On chambers of elastances ``per_a``, ``per_b``, in Pa/m3; 0: exactly V5.
    """
    pa, at, bt, pb = opened
    delta_a = smoothing(pa + at, per_a, valve.delta)
    delta_b = smoothing(pb + bt, per_b, valve.delta)
    return (signed_sqrt(p_s - p_a, delta_a), signed_sqrt(p_a - p_t, delta_a),
            signed_sqrt(p_b - p_t, delta_b), signed_sqrt(p_s - p_b, delta_b))


@kernel
def metered(opened, roots):
    """Return (q_a, q_b, q_p, q_t) of the lands, in m3/s  (V7, V9)."""
    q_pa, q_at = opened[0] * roots[0], opened[1] * roots[1]
    q_bt, q_pb = opened[2] * roots[2], opened[3] * roots[3]
    return q_pa - q_at, q_pb - q_bt, q_pa + q_pb, q_at + q_bt


@kernel
def land_losses(opened, leaks, roots, p_a, p_b, p_s, p_t):
    """Return the powers that the lands lose to leakage and to throttling, in W  (E2)."""
    w_pa, w_at = roots[0] * (p_s - p_a), roots[1] * (p_a - p_t)
    w_bt, w_pb = roots[2] * (p_b - p_t), roots[3] * (p_s - p_b)
    leakage = leaks[0] * w_pa + leaks[1] * w_at + leaks[2] * w_bt + leaks[3] * w_pb
    throttling = ((opened[0] - leaks[0]) * w_pa + (opened[1] - leaks[1]) * w_at
                  + (opened[2] - leaks[2]) * w_bt + (opened[3] - leaks[3]) * w_pb)
    return leakage, throttling


@kernel
def tare_flow(p_s, p_t, valve):
    """Return the flow of the pilot stage from supply to return, in m3/s  (V9)."""
    return valve.c_tare * signed_sqrt(p_s - p_t, valve.delta)


@kernel
def port_flows(x, p_a, p_b, p_s, p_t, valve):
    """
    Return (q_a, q_b, q_p, q_t) in m3/s at spool ``x`` (m) and pressures in Pa  (V7, V9).

    Equations 11 to 18 of the paper as `Q = (g + leakage) sqrt(dP / dP_ref)` for each of the
    four lands, plus the pilot stage's tare flow from supply to return.
    """
    opened, _ = conductances(x, valve)
    q_a, q_b, q_p, q_t = metered(
        opened, root_drops(opened, p_a, p_b, p_s, p_t, 0.0, 0.0, valve))
    q_tare = tare_flow(p_s, p_t, valve)
    return q_a, q_b, q_p + q_tare, q_t + q_tare
