"""
The two oil chambers: volumes, pressures, cavities, and the force they make.

Chamber A is the cap side: its pressure extends. ``s`` is the piston position in m (rotor
angle in rad), 0 at the retracted end, ``area`` the piston area in m2 (displacement D_m in
m3/rad). Pressures are gauge. Each swept volume is counted once (errata 16). The state is the
pressure of each chamber, and while its oil boils the volume of the cavity; a step that touches
pressures below the atmosphere, or oil with air, is one of volumes (C11, `cavitation`).
"""

import math

from isa_ros.core.constants import ATMOSPHERE
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import fault, parameter, Parameters
from isa_ros.core.record import record
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.core.units import MILLILITRE
from isa_ros.errors import ParameterError
from isa_ros.plant.cavitation import contents, lack, LEAST_AIR_PRESSURE, modulus
from isa_ros.plant.drives import Cylinder, Vane
from isa_ros.plant.motor import Motor
import numpy as np


@frozen(kw_only=True)
class ChamberOil(Parameters):
    """The enclosed oil and the leakage past the piston."""

    effective_bulk_modulus: float = parameter('beta_eff', 'Pa', gt=0.0, le=2.0e9)
    dead_volume_ml: float = parameter('V_p of each chamber', 'ml', gt=0.0, le=1e5)
    cross_port_leakage: float = parameter(
        'C_li', 'm3/s/Pa', changeable=True, ge=0.0, le=1e-11)
    aeration_pressure_kpa: float = parameter(
        'pressure below the atmosphere at which released air halves the bulk modulus',
        'kPa', gt=0.0, le=100.0)
    vapour_pressure_kpa: float = parameter(
        'absolute pressure at which the oil boils', 'kPa', ge=0.0, le=50.0)
    temperature_celsius: float = parameter(
        'of the oil, which shifts the null of the valve', 'celsius', ge=-30.0, le=80.0)
    entrained_air: float = fault(
        'volume of air per volume of oil and air, at atmospheric pressure', '1', ge=0.0, le=0.2)
    external_leakage_a: float = fault(
        'C_le, from chamber A to the outside', 'm3/s/Pa', ge=0.0, le=1e-11)
    external_leakage_b: float = fault(
        'C_le, from chamber B to the outside', 'm3/s/Pa', ge=0.0, le=1e-11)

    def __post_init__(self) -> None:
        """Refuse oil that expands by more than `MOST_EXPANSION` before it boils  (C5)."""
        super().__post_init__()
        drop = ATMOSPHERE - self.vapour_pressure_kpa * 1e3
        stiffest = MOST_EXPANSION * self.effective_bulk_modulus - drop
        if stiffest <= 0.0:
            raise ParameterError(
                f'effective_bulk_modulus = {self.effective_bulk_modulus:g} Pa, must be > '
                f'{drop / MOST_EXPANSION:g} Pa, or the oil never boils')
        softest = 0.5e-3 * drop * drop / stiffest
        if self.aeration_pressure_kpa < softest:
            raise ParameterError(
                f'aeration_pressure_kpa = {self.aeration_pressure_kpa:g} kPa, must be >= '
                f'{softest:.3g} kPa with this bulk modulus, or the oil never boils')


CHAMBERS = np.dtype([
    ('area_a', 'f8'), ('area_b', 'f8'), ('stroke', 'f8'),
    ('dead_volume', 'f8'), ('beta', 'f8'), ('c_li', 'f8'), ('p_air', 'f8'),
    ('p_vapour', 'f8'),     # Pa gauge
    ('air', 'f8'), ('leaks_out', 'f8'), ('c_le_a', 'f8'), ('c_le_b', 'f8'),
    ('least_a', 'f8'), ('least_b', 'f8'),   # m3, below which a step is one of volumes
    ('holds_b', 'f8'),      # 0: chamber B is open, and no spring of oil
    ('swept_a', 'f8'), ('swept_b', 'f8')])  # growth of the volumes: the areas; 0: of a motor
MOST_EXPANSION = 100.0  # 1, integral of dp/beta down to the vapour pressure: e^100 is a number
FASTEST_SPRING = 0.2    # rad in a step: RK4 of pressures loses 1e-10 of the oil at rest in it
MOST_SWEPT = 0.01       # 1, of a chamber's volume z in a step: RK4 of pressures loses z^5/120
CHAMBERS_STATE = np.dtype([
    ('p_a', 'f8'), ('p_b', 'f8'),
    ('cavity_a', 'f8'), ('cavity_b', 'f8')])    # m3 of vapour; within a step of volumes: `lack`


def chambers_record(
        drive: Cylinder | Vane | Motor, oil: ChamberOil, inertia: float = math.inf) -> np.record:
    """
    Return the `CHAMBERS` record; air of no pressure would fill any volume  (C12).

    The oil of a smaller chamber than its least is a spring of ``inertia`` (kg | kg m2) that is
    faster than `FASTEST_SPRING`.
    """
    area_a, area_b = drive.areas
    swept_a, swept_b = (0.0, 0.0) if isinstance(drive, Motor) else drive.areas
    slowest = PLANT_STEP / FASTEST_SPRING
    least = oil.effective_bulk_modulus / inertia * slowest * slowest
    vapour = oil.vapour_pressure_kpa * 1e3
    if oil.entrained_air > 0.0:
        vapour = max(vapour, LEAST_AIR_PRESSURE)
    return record(
        CHAMBERS, area_a=area_a, area_b=area_b, stroke=drive.stroke,
        dead_volume=oil.dead_volume_ml * MILLILITRE, beta=oil.effective_bulk_modulus,
        c_li=oil.cross_port_leakage, p_air=oil.aeration_pressure_kpa * 1e3,
        p_vapour=vapour - ATMOSPHERE, air=oil.entrained_air,
        leaks_out=float(oil.external_leakage_a + oil.external_leakage_b > 0.0),
        c_le_a=oil.external_leakage_a, c_le_b=oil.external_leakage_b,
        least_a=least * area_a * area_a, least_b=least * area_b * area_b,
        holds_b=1.0, swept_a=swept_a, swept_b=swept_b)


@kernel
def volumes(s, chambers):
    """Return (V_A, V_B) = (V_p + A_A s, V_p + A_B (L - s)) in m3  (C1); of a motor V_p  (M6)."""
    return (chambers.dead_volume + chambers.swept_a * s,
            chambers.dead_volume + chambers.swept_b * (chambers.stroke - s))


@kernel
def filling(y, v, chambers):
    """
    Return which share of its displacement a motor takes in as oil, 1: all of it  (M9).

    1 - D/V_p of a cavity D at its inlet; of a piston, which sweeps its own volume, 1. ``y`` is a
    `CHAMBERS_STATE`.
    """
    if chambers.swept_a > 0.0:
        return 1.0
    cavity = y.cavity_a if v > 0.0 else y.cavity_b
    return 1.0 - max(0.0, cavity) / chambers.dead_volume


@kernel
def external_leakage(p, c_le):
    """Return C_le max(0, P), the leakage from a chamber to the outside, in m3/s  (C13)."""
    return c_le * max(0.0, p)


@kernel
def leakage_loss(p_a, p_b, chambers):
    """Return the power of the leakage past the piston and of `external_leakage`, in W  (E3)."""
    loss = chambers.c_li * (p_a - p_b) * (p_a - p_b)
    if chambers.leaks_out > 0.0:
        loss += (p_a * external_leakage(p_a, chambers.c_le_a)
                 + p_b * external_leakage(p_b, chambers.c_le_b))
    return loss


@kernel
def elastances(s, chambers):
    """
    Return (beta/V_A, beta/V_B) of oil above the atmosphere without air, in Pa/m3  (C1, C2).

    The volumes are positive within the range of the end stops.
    """
    v_a, v_b = volumes(s, chambers)
    return chambers.beta / v_a, chambers.beta / v_b


@kernel
def surpluses(q_a, q_b, p_a, p_b, v, chambers):
    """
    Return the oil that each chamber gains beyond what its piston sweeps, in m3/s  (C2).

    Times the elastance it is dP/dt, equations 3 and 4 of the paper. ``q_a`` and ``q_b`` (m3/s)
    are all flows into a chamber except the cross-port leakage and those to the outside  (C13).
    """
    q_li = chambers.c_li * (p_a - p_b)
    in_a, in_b = q_a - chambers.area_a * v - q_li, q_b + chambers.area_b * v + q_li
    if chambers.leaks_out > 0.0:
        in_a -= external_leakage(p_a, chambers.c_le_a)
        in_b -= external_leakage(p_b, chambers.c_le_b)
    return in_a, in_b


@kernel
def pressure_rates(q_a, q_b, p_a, p_b, s, v, chambers):
    """Return (dP_A/dt, dP_B/dt) in Pa/s of `surpluses`, without cavities  (C2, C5, C12)."""
    in_a, in_b = surpluses(q_a, q_b, p_a, p_b, v, chambers)
    v_a, v_b = volumes(s, chambers)
    return modulus(p_a, chambers) / v_a * in_a, modulus(p_b, chambers) / v_b * in_b


@kernel
def is_of_volumes(h, y, s, v, chambers):
    """
    Return whether a step of ``h`` s from a `CHAMBERS_STATE` has volumes for its states  (C11).

    Below the atmosphere, with a cavity or air, and in a chamber that is too small for a step of
    pressures: by `FASTEST_SPRING`, or because the piston sweeps too much of it.
    """
    v_a, v_b = volumes(s, chambers)
    swept = h * abs(v)
    return (min(y.p_a, y.p_b) < 0.0 or max(y.cavity_a, y.cavity_b) > 0.0 or chambers.air > 0.0
            or v_a < chambers.least_a or swept * chambers.swept_a > MOST_SWEPT * v_a
            or v_b < chambers.least_b or swept * chambers.swept_b > MOST_SWEPT * v_b)


@kernel
def begin_volumes(y, v_a, v_b, chambers):
    """Begin a step of volumes: write the `lack` of both chambers in place of their cavities."""
    y.cavity_a = lack(y.p_a, y.cavity_a, v_a, chambers)
    y.cavity_b = lack(y.p_b, y.cavity_b, v_b, chambers)


@kernel
def end_volumes(y, v_a, v_b, chambers):
    """End a step of volumes: write pressures and cavities of what both chambers lack  (C11)."""
    y.p_a, _, _ = contents(y.cavity_a, v_a, y.p_a, chambers)
    y.p_b, _, _ = contents(y.cavity_b, v_b, y.p_b, chambers)
    y.cavity_a, y.cavity_b = max(0.0, y.cavity_a), max(0.0, y.cavity_b)


@kernel
def lack_rates(gained_a, gained_b, more_a, more_b, v, chambers):
    """
    Return the rates of both `lack`, A s' - e Q_A and -A s' - e Q_B, in m3/s  (C11).

    ``gained_a`` is Q_A - A s', the oil that a chamber gains beyond what its piston sweeps; e is
    1 + ``more_a``, the density of its oil over that at the vapour pressure. The volumes of a motor
    do not change.
    """
    return (-gained_a - more_a * (gained_a + chambers.swept_a * v),
            -gained_b - more_b * (gained_b - chambers.swept_b * v))


@kernel
def chamber_rates(of_volumes, gained_a, gained_b, oil_a, oil_b, v, wider_a, wider_b, chambers,
                  rates):
    """
    Write the rates of a `CHAMBERS_STATE`: of its pressures  (C2), or of both `lack`  (C11).

    ``oil_a`` and ``oil_b`` are pressure, elastance and density of each, ``wider_a`` and
    ``wider_b`` what a spear in the chamber adds to a `lack`, in m3/s.
    """
    if of_volumes:
        rates.p_a = rates.p_b = 0.0
        rates.cavity_a, rates.cavity_b = lack_rates(
            gained_a, gained_b, oil_a[2], oil_b[2], v, chambers)
        rates.cavity_a += wider_a
        rates.cavity_b += wider_b
    else:
        rates.p_a, rates.p_b = oil_a[1] * gained_a, oil_b[1] * gained_b
        rates.cavity_a = rates.cavity_b = 0.0


@kernel
def hydraulic_force(p_a, p_b, chambers):
    """Return f_h = A_A P_A - A_B P_B in N or Nm  (C3, equations 5 and 6 of the paper)."""
    return chambers.area_a * p_a - chambers.area_b * p_b


@kernel
def oil_stiffness(s, chambers):
    """Return beta (A_A^2/V_A + A_B^2/V_B) of the trapped oil, in N/m or Nm/rad  (C4)."""
    v_a, v_b = volumes(s, chambers)
    return chambers.beta * (chambers.area_a * chambers.area_a / v_a
                            + chambers.holds_b * chambers.area_b * chambers.area_b / v_b)
