"""
Cushioned ends: a spear closes the port of a chamber near the end and traps the oil behind it.

Over its length the spear divides the chamber: the port's side keeps pressure, lands, relief and
leakage of the chamber; the trapped side, of the area around the spear, is emptied through the
restriction and what the entering spear leaves open of the port, and filled through a check valve
as well. Both ends are written alike: ``d`` is the distance to the end, m, and ``v`` its rate.
While a spear is in, steps have volumes for their states (C11), so that no oil is lost. Neglected:
the leakage past the piston from the trapped side, the oil's inertia, the travel of the check
valve, and that the restriction of an adjusting screw opens with temperature.
"""

import math

from isa_ros.core.kernel import kernel
from isa_ros.core.orifice import root_slope, signed_sqrt
from isa_ros.core.record import record
from isa_ros.core.timebase import FASTEST_RATE
from isa_ros.core.units import LPM, MILLI, MILLILITRE, MPA
from isa_ros.plant.cavitation import contents, lack
from isa_ros.plant.chambers import volumes
from isa_ros.plant.cushion_sheets import Cushion, NoneCushion, OPEN, SHUT, trapped_area
import numpy as np

CUSHION = np.dtype([
    ('is_on', 'f8'),            # 1: there is one at this end
    ('length', 'f8'), ('entry', 'f8'),          # m
    ('area', 'f8'),             # of the trapped side, m2
    ('dead', 'f8'),             # m3
    ('k_port', 'f8'), ('k_restriction', 'f8'), ('k_check', 'f8'),   # m3/s/sqrt(Pa)
    ('p_check', 'f8'),          # drop that opens the check valve, Pa
    ('is_shut', 'f8'), ('is_open', 'f8'),       # of the check valve, whatever the drop
])
CUSHION_STATE = np.dtype([
    ('end', 'f8'),              # -1: the spear of A is in, the retracted end's; 1: that of B; 0
    ('p', 'f8'),                # of the trapped side, Pa
    ('cavity', 'f8')])          # m3 of vapour in it; within a step: `lack`

_DELTA = 1e5    # Pa, of V5
_LEAST = 0.1    # of the trapped dead volume: what a stop that yields leaves of it


def cushion_record(sheet: Cushion, area: float) -> np.record:
    """Return the `CUSHION` record of a sheet with the ``area`` of its trapped side, m2."""
    if isinstance(sheet, NoneCushion):
        return record(CUSHION, **dict.fromkeys(CUSHION.names or (), 0.0))
    root = math.sqrt(sheet.rated_drop_mpa * MPA)
    return record(
        CUSHION, is_on=1.0, length=sheet.length_mm * MILLI, entry=sheet.entry_mm * MILLI,
        area=area, dead=sheet.trapped_ml * MILLILITRE, k_port=sheet.port_lpm * LPM / root,
        k_restriction=(1.0 - sheet.restriction_blocked) * sheet.restriction_lpm * LPM / root,
        k_check=sheet.check_lpm * LPM / root, p_check=sheet.check_opening_kpa * 1e3,
        is_shut=float(sheet.check_stuck == SHUT), is_open=float(sheet.check_stuck == OPEN))


def cushion_records(plant: object) -> dict[str, np.record]:
    """Return those of both ends of the sheet of a plant; only cylinders have any."""
    none = NoneCushion()
    sheets = {name: getattr(plant, name, none) for name in ('cushion_a', 'cushion_b')}
    return {name: cushion_record(own, 0.0 if own == none else trapped_area(
        own, getattr(plant, 'drive').bore_mm)) for name, own in sheets.items()}


@kernel
def trapped_volume(d, cushion):
    """
    Return the volume of the trapped side, V_0 + A d  (C30), in m3.

    At least a tenth of V_0, however far the end stop yields.
    """
    return max(cushion.dead + cushion.area * d, _LEAST * cushion.dead)


@kernel
def port_volumes(end, s, plant):
    """Return (V_A, V_B) of the ports' sides, those of C1 less the trapped volume  (C30)."""
    v_a, v_b = volumes(s, plant.chambers)
    if end < 0.0:
        v_a -= trapped_volume(s, plant.cushion_a)
    elif end > 0.0:
        v_b -= trapped_volume(plant.chambers.stroke - s, plant.cushion_b)
    return v_a, v_b


@kernel
def open_conductance(d, cushion):
    """
    Return that of restriction and port, K_r + K_p (1 - (l - d)/e)^2, in m3/s/sqrt(Pa)  (C31).

    The port's part ends after the entry e of the length l.
    """
    left = max(0.0, 1.0 - (cushion.length - d) / cushion.entry)
    return cushion.k_restriction + cushion.k_port * left * left


@kernel
def outflow(dp, d, cushion):
    """
    Return the flow from the trapped to the port's side and its slope  (C31), m3/s, m3/s/Pa.

    K S(dp) of `open_conductance`, less that of the check valve beyond its opening.
    """
    k = open_conductance(d, cushion)
    if cushion.is_open > 0.0:
        k += cushion.k_check
    flow, slope = k * signed_sqrt(dp, _DELTA), k * root_slope(dp, _DELTA)
    beyond = -dp - cushion.p_check
    if beyond > 0.0 and cushion.is_shut == 0.0 and cushion.is_open == 0.0:
        flow -= cushion.k_check * signed_sqrt(beyond, _DELTA)
        slope += cushion.k_check * root_slope(beyond, _DELTA)
    return flow, slope


@kernel
def eased_outflow(dp, d, in_trapped, per_trapped, in_port, per_port, cushion):
    """
    Return `outflow` as a step can follow it, in m3/s  (C32).

    ``in_...`` is what each side gains without it (m3/s), ``per_...`` its elastance (Pa/m3). Both
    together, dp decays towards the drop at which it stays; faster than `FASTEST_RATE` it has that
    rate: the drop at rest is the same, and no oil is lost, as in C10. A check valve alone never
    lets any out.
    """
    flow, slope = outflow(dp, d, cushion)
    elastance = per_trapped + per_port
    rate = slope * elastance
    if rate <= FASTEST_RATE:
        return flow
    steady = (per_trapped * in_trapped - per_port * in_port) / elastance
    eased = steady + (flow - steady) * (FASTEST_RATE / rate)
    if open_conductance(d, cushion) == 0.0 and cushion.is_open == 0.0:
        return min(0.0, eased)
    return eased


@kernel
def pass_spear(y, d, v, p, per, more, gained, oil, cushion, rates):
    """
    Write the rate of a trapped side; return what it does to the port's side and the piston.

    ``y`` is its `CUSHION_STATE` within a step of volumes; ``p``, ``per``, ``more`` are the
    `contents` of the port's side, ``gained`` what that gains as if it had the whole piston, m3/s.
    Returns what it gains with the spear in, the change of the force outwards (N), the power lost
    at the spear (W) and that stored in the trapped oil (E2, E6). What flows has the density of
    the side it comes from.
    """
    volume = trapped_volume(d, cushion)
    p_c, per_c, more_c = contents(y.cavity, volume, y.p, oil)
    swept = cushion.area * v
    gained += swept
    flow = eased_outflow(p_c - p, d, -swept, per_c, gained, per, cushion)
    mass = flow * (1.0 + (more_c if flow > 0.0 else more))
    left, came = mass / (1.0 + more_c), mass / (1.0 + more)
    rates.cavity = swept + mass
    return (gained + came, cushion.area * (p_c - p), p_c * left - p * came,
            -p_c * (swept + left))


@kernel
def pass_spears(y, s, v, port_a, port_b, plant, rates):
    """
    Write the rates of a `CUSHION_STATE`; return what a spear that is in changes.

    Each port has pressure, elastance, `denser` and gain of its chamber. Returns both gains, the
    force (N), the powers lost and stored (W), and the additions to the rates of both `lack`, of
    which the piston sweeps only the port's side.
    """
    rates.end = rates.p = rates.cavity = 0.0
    p_a, per_a, more_a, in_a = port_a
    p_b, per_b, more_b, in_b = port_b
    push, lost, kept, wider_a, wider_b = 0.0, 0.0, 0.0, 0.0, 0.0
    if y.end < 0.0:
        in_a, push, lost, kept = pass_spear(
            y, s, v, p_a, per_a, more_a, in_a, plant.chambers, plant.cushion_a, rates)
        wider_a = more_a * plant.cushion_a.area * v
    elif y.end > 0.0:
        in_b, push, lost, kept = pass_spear(
            y, plant.chambers.stroke - s, -v, p_b, per_b, more_b, in_b, plant.chambers,
            plant.cushion_b, rates)
        push, wider_b = -push, -more_b * plant.cushion_b.area * v
    return in_a, in_b, push, lost, kept, wider_a, wider_b


@kernel
def begin_trapped(y, s, plant):
    """Begin a step of volumes: write the `lack` of the trapped side in place of its cavity."""
    if y.end < 0.0:
        y.cavity = lack(y.p, y.cavity, trapped_volume(s, plant.cushion_a), plant.chambers)
    elif y.end > 0.0:
        d = plant.chambers.stroke - s
        y.cavity = lack(y.p, y.cavity, trapped_volume(d, plant.cushion_b), plant.chambers)


@kernel
def end_trapped(y, s, plant):
    """End a step of volumes: write pressure and cavity of the trapped side  (C11)."""
    if y.end == 0.0:
        return
    if y.end < 0.0:
        volume = trapped_volume(s, plant.cushion_a)
    else:
        volume = trapped_volume(plant.chambers.stroke - s, plant.cushion_b)
    y.p, _, _ = contents(y.cavity, volume, y.p, plant.chambers)
    y.cavity = max(0.0, y.cavity)


@kernel
def joined(p, cavity, volume, p_c, cavity_c, trapped, oil):
    """Return pressure and cavity of two sides that become one: what both lack adds up."""
    lacking = lack(p, cavity, volume, oil) + lack(p_c, cavity_c, trapped, oil)
    p, _, _ = contents(lacking, volume + trapped, p, oil)
    return p, max(0.0, lacking)


@kernel
def divide(y, plant):
    """Divide a chamber of a `PLANT_STATE` as the spear enters, join it as it leaves  (C30)."""
    s, stroke, own, oil = y.mechanics.position, plant.chambers.stroke, y.cushion, y.chambers
    end = 0.0
    if plant.cushion_a.is_on > 0.0 and s < plant.cushion_a.length:
        end = -1.0
    elif plant.cushion_b.is_on > 0.0 and stroke - s < plant.cushion_b.length:
        end = 1.0
    if end == own.end:
        return
    v_a, v_b = port_volumes(own.end, s, plant)
    if own.end < 0.0:
        oil.p_a, oil.cavity_a = joined(
            oil.p_a, oil.cavity_a, v_a, own.p, own.cavity, trapped_volume(s, plant.cushion_a),
            plant.chambers)
    elif own.end > 0.0:
        oil.p_b, oil.cavity_b = joined(
            oil.p_b, oil.cavity_b, v_b, own.p, own.cavity,
            trapped_volume(stroke - s, plant.cushion_b), plant.chambers)
    own.end, own.p, own.cavity = end, 0.0, 0.0
    v_a, v_b = volumes(s, plant.chambers)
    if end < 0.0:
        own.p = oil.p_a
        own.cavity = oil.cavity_a * (trapped_volume(s, plant.cushion_a) / v_a)
        oil.cavity_a -= own.cavity
    elif end > 0.0:
        own.p = oil.p_b
        own.cavity = oil.cavity_b * (trapped_volume(stroke - s, plant.cushion_b) / v_b)
        oil.cavity_b -= own.cavity
