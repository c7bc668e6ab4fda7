"""
A valve-driven cylinder with a reference solution, made of the plant's own equations.

A loaded differential cylinder follows a sine under sampled position control. Its solution is
known to twelve digits, so it shows how exactly these equations can be integrated and at what
cost, in comparison with any other simulator of hydraulics. ``x`` counts from mid stroke, the spool
opening ``u`` from -1 to 1; signs are those of the chambers. The command
u_r = K (x_r - x) is held for a millisecond and never reaches 1.

The right-hand side is smooth except where the spool passes null; there a step is cut in two.
One step of order eight then covers a hold: its error is a thousandth of that of four classical
steps of order four, in less time.
"""

import math

from isa_ros.core.kernel import called_kernel, kernel
from isa_ros.core.record import rows_of
from isa_ros.core.units import LPM, MILLI, MPA
from isa_ros.plant import chambers, servo_valve, spool, valve_record
from isa_ros.plant.drives import Cylinder
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853

STATES = ('x', 'v', 'p_a', 'p_b', 'u', 'u_rate')  # m, m/s, Pa, Pa, 1, 1/s
HOLD = 1e-3                                       # s, of the command
STAGES = 12                                       # evaluations in a step
_NEWTON_STEPS = 6  # from a secant: its error is squared each time, 1e-1 to below 1e-16 in five

CYLINDER = np.dtype([
    ('valve', valve_record.VALVE), ('spool', spool.SPOOL), ('chambers', chambers.CHAMBERS),
    ('p_s', 'f8'), ('p_t', 'f8'),                               # Pa
    ('mass', 'f8'), ('damping', 'f8'), ('stiffness', 'f8'),     # kg, Ns/m, N/m
    ('gain', 'f8'), ('amplitude', 'f8'), ('omega', 'f8'),       # 1/m, m, rad/s
])

# Prince and Dormand's method of order 8, the coefficients that are not zero of each stage.
A_2, A_3, A_4, A_5, A_6, A_7, A_8, A_9, A_10, A_11, A_12, B = (
    tuple(float(a) for a in row if a != 0.0) for row in (*DOP853.A[1:STAGES], DOP853.B))


def cylinder_record() -> NDArray[np.void]:
    """
    Return the `CYLINDER` record of the case, shape (1,).

    Bore 21.5, rod 12, stroke 100 mm, 1 ml dead volume a side; one slope of 7.5 l/min a land at
    3.5 MPa and u = 1, equal lands, no valve leakage, orifices without smoothing (delta = 0; no
    pressure drop comes near zero).
    """
    record = rows_of(1, CYLINDER)
    case = record[0]
    case.chambers = chambers.chambers_record(
        Cylinder(bore_mm=21.5, rod_mm=12.0, cap_rod_mm=0.0, stroke_mm=100.0,
                 rated_pressure_mpa=20.7),
        chambers.ChamberOil(
            effective_bulk_modulus=7e8, dead_volume_ml=1.0, cross_port_leakage=1e-13,
            aeration_pressure_kpa=5.0, vapour_pressure_kpa=1.0, temperature_celsius=40.0))
    valve = case.valve
    valve.k_low = valve.k_high = 7.5 * LPM
    valve.x_dg = valve.x_max = valve.x_l = 1.0
    valve.per_root_drop = 1.0 / math.sqrt(3.5 * MPA)
    valve.f_pa = valve.f_at = valve.f_bt = valve.f_pb = 1.0
    case.spool.w_n, case.spool.zeta = 2.0 * math.pi * 120.0, 0.7
    case.p_s, case.p_t = 20.7 * MPA, 0.0
    case.mass, case.damping, case.stiffness = 10.0, 200.0, 1e5
    case.gain, case.amplitude, case.omega = 60.0, 5.0 * MILLI, 2.0 * math.pi * 2.0
    return record


@called_kernel
def slope(y, command, cylinder):
    """
    Return dy/dt of the `STATES`; m v' = f_h - d v - c x  (V7, V10, C1, C2, C3).

    No pressure comes near the atmosphere, so that the modulus is constant.
    """
    x, v, p_a, p_b, u, u_rate = y
    closed, oil = cylinder.spool, cylinder.chambers
    q_a, q_b, _, _ = servo_valve.port_flows(
        u, p_a, p_b, cylinder.p_s, cylinder.p_t, cylinder.valve)
    in_a, in_b = chambers.surpluses(q_a, q_b, p_a, p_b, v, oil)
    per_a, per_b = chambers.elastances(0.5 * oil.stroke + x, oil)
    force = (chambers.hydraulic_force(p_a, p_b, oil)
             - cylinder.damping * v - cylinder.stiffness * x)
    return (v, force / cylinder.mass, per_a * in_a, per_b * in_b, u_rate,
            spool.spool_acceleration(command, u, u_rate, closed.w_n, closed.zeta))


@kernel
def ahead(y, h, weights, slopes):
    """Return y + h times the weighted sum of as many slopes, the newest slope added last."""
    a, b, c, d, e, f = y
    for i in range(len(weights)):
        weight, k = h * weights[i], slopes[i]
        a += weight * k[0]
        b += weight * k[1]
        c += weight * k[2]
        d += weight * k[3]
        e += weight * k[4]
        f += weight * k[5]
    return a, b, c, d, e, f


@called_kernel
def step(y, h, r, case):
    """Return y after one step of order 8 of ``h`` seconds under the command ``r``."""
    k_1 = slope(y, r, case)
    k_2 = slope(ahead(y, h, A_2, (k_1,)), r, case)
    k_3 = slope(ahead(y, h, A_3, (k_1, k_2)), r, case)
    k_4 = slope(ahead(y, h, A_4, (k_1, k_3)), r, case)
    k_5 = slope(ahead(y, h, A_5, (k_1, k_3, k_4)), r, case)
    k_6 = slope(ahead(y, h, A_6, (k_1, k_4, k_5)), r, case)
    k_7 = slope(ahead(y, h, A_7, (k_1, k_4, k_5, k_6)), r, case)
    k_8 = slope(ahead(y, h, A_8, (k_1, k_4, k_5, k_6, k_7)), r, case)
    k_9 = slope(ahead(y, h, A_9, (k_1, k_4, k_5, k_6, k_7, k_8)), r, case)
    k_10 = slope(ahead(y, h, A_10, (k_1, k_4, k_5, k_6, k_7, k_8, k_9)), r, case)
    k_11 = slope(ahead(y, h, A_11, (k_1, k_4, k_5, k_6, k_7, k_8, k_9, k_10)), r, case)
    k_12 = slope(ahead(y, h, A_12, (k_1, k_4, k_5, k_6, k_7, k_8, k_9, k_10, k_11)), r, case)
    return ahead(y, h, B, (k_1, k_6, k_7, k_8, k_9, k_10, k_11, k_12))


@kernel
def split_step(y, end, h, r, case):
    """
    Return y after two steps that meet where the spool passes null within ``h``.

    ``end`` is the result of one step over ``h``. For a spool that touches null and turns back
    the instant of the kink is inexact, and the error is that of a step that is not cut.
    """
    passed = h * y[4] / (y[4] - end[4])
    for _ in range(_NEWTON_STEPS):
        null = step(y, passed, r, case)
        passed = min(h, max(0.0, passed - null[4] / null[5]))
    return step(step(y, passed, r, case), h - passed, r, case)


@kernel
def cylinder_run(steps, cylinders, states):
    """
    Fill ``states``, shape (holds + 1, 6), from its first row, in ``steps`` steps a hold.

    Each hold has one row: the states at the instant at which it begins.
    """
    case = cylinders[0]
    h = HOLD / steps
    row = states[0]
    y = (row[0], row[1], row[2], row[3], row[4], row[5])
    for i in range(len(states) - 1):
        r = case.gain * (case.amplitude * math.sin(case.omega * (i * HOLD)) - y[0])
        for _ in range(steps):
            end = step(y, h, r, case)
            y = split_step(y, end, h, r, case) if y[4] * end[4] < 0.0 else end
        for j in range(len(y)):
            states[i + 1, j] = y[j]


def at_rest(holds: int, cylinder: np.record) -> np.ndarray:
    """Return an array for the states of ``holds`` holds; the first is at rest and in balance."""
    states = np.zeros((holds + 1, len(STATES)))
    p_b = 0.5 * cylinder.p_s
    states[0, 2:4] = p_b * cylinder.chambers.area_b / cylinder.chambers.area_a, p_b
    return states


def simulate(holds: int, steps: int = 1) -> np.ndarray:
    """Return the `STATES` at every millisecond of ``holds``, shape (holds + 1, 6)."""
    cylinders = cylinder_record()
    states = at_rest(holds, cylinders[0])
    cylinder_run(steps, cylinders, states)
    return states
