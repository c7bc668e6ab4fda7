"""
Metering of the servo valve: four lands, their flow curve, leakage and lap.

``x > 0`` opens P-A and B-T and extends. Chamber flows are positive INTO the chamber,
``q_p`` positive OUT OF the supply and ``q_t`` positive INTO the return.
Neglected: flow forces.
"""

import math

from isa_ros.core.elementary import exp
from isa_ros.core.kernel import kernel
from isa_ros.core.orifice import signed_sqrt
from isa_ros.core.piecewise import y_on_lines
from isa_ros.core.timebase import FASTEST_RATE
import numpy as np


def largest_flow_slope(valve: np.record, span: float) -> float:
    """
    Return dQ/dP of the wide-open valve with ``span`` (Pa) over two lands, in m3/s/Pa.

    A supply below the return has a negative one, through which oil flows the other way.
    """
    drop = abs(span)
    flow = flow_curve(valve.x_max, valve) * math.sqrt(0.5 * drop) * valve.per_root_drop
    return float(0.5 * flow / drop)


@kernel
def flow_curve(opening, valve):
    """
    Return g, the flow of one open land at the reference drop  (V4, eq 19), in m3/s.

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
    Return q_0 x_l / (x_l + abs(u)), a land's leakage at the reference drop  (V6), in m3/s.

    ``travel`` is abs(u): how far it is open or closed, in m.

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
def back_flow(opening, valve):
    """Return g(u) + l of the lands A-T and P-B with a curve of their own  (V14, V15), in m3/s."""
    leak = leakage(abs(opening), valve)
    return y_on_lines(opening, valve.back) + leak if opening > 0.0 else leak


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
        if valve.has_sides > 0.0:
            at, pb = back_flow(-x - valve.lap_at, valve), back_flow(-x - valve.lap_pb, valve)
    else:
        travel = abs(x)
        leak = leakage(travel, valve)
        if valve.has_sides > 0.0 and x < 0.0:
            opened = back_flow(travel, valve)
        else:
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

    On chambers of elastances ``per_a``, ``per_b``, in Pa/m3; 0: exactly V5. The drop over a land
    from the supply is at most that of a pressure compensator in front of it  (V30).
    """
    pa, at, bt, pb = opened
    delta_a = smoothing(pa + at, per_a, valve.delta)
    delta_b = smoothing(pb + bt, per_b, valve.delta)
    roots = smoothed_roots(p_a, p_b, p_s, p_t, delta_a, delta_b)
    if valve.most_drop > 0.0:
        return (signed_sqrt(min(p_s - p_a, valve.most_drop), delta_a), roots[1], roots[2],
                signed_sqrt(min(p_s - p_b, valve.most_drop), delta_b))
    return roots


@kernel
def smoothed_roots(p_a, p_b, p_s, p_t, delta_a, delta_b):
    """Return S(dP) of the lands P-A, A-T, B-T, P-B  (V5), in sqrt(Pa); each delta in Pa."""
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

    Equations 11 to 18 of the paper (19 is `flow_curve`) as `Q = (g + leakage) sqrt(dP / dP_ref)`
    for each of the four lands, plus the pilot stage's tare flow from supply to return.
    """
    opened, _ = conductances(x, valve)
    q_a, q_b, q_p, q_t = metered(
        opened, root_drops(opened, p_a, p_b, p_s, p_t, 0.0, 0.0, valve))
    q_tare = tare_flow(p_s, p_t, valve)
    return q_a, q_b, q_p + q_tare, q_t + q_tare
