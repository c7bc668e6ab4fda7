"""
Overload protection of each chamber: relief to return, refill from return.

Flows are positive OUT OF the chamber. Both valves are static.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import record
from isa_ros.core.timebase import FASTEST_RATE
from isa_ros.core.units import LPM, MPA
import numpy as np


@frozen(kw_only=True)
class Relief(Parameters):
    """Relief and anti-cavitation valves of one chamber."""

    opening_pressure_mpa: float = parameter(
        'gauge pressure that opens it', 'MPa', changeable=True, gt=0.0, le=100.0)
    slope_lpm_per_mpa: float = parameter(
        'relief flow per pressure above opening', 'l/min/MPa', gt=0.0, le=1e4)
    refill_lpm: float = parameter(
        'anti-cavitation flow at 0.1 MPa below return', 'l/min', gt=0.0, le=1000.0)


RELIEF = np.dtype([('p_open', 'f8'), ('slope', 'f8'), ('c_refill', 'f8')])
_REFILL_DROP = 1e5  # Pa below return at which `refill_lpm` is stated


def relief_record(sheet: Relief) -> np.record:
    """Return the `RELIEF` record of a sheet."""
    return record(
        RELIEF, p_open=sheet.opening_pressure_mpa * MPA,
        slope=sheet.slope_lpm_per_mpa * LPM / MPA,
        c_refill=sheet.refill_lpm * LPM / (_REFILL_DROP * _REFILL_DROP))


@kernel
def relief_flow(p, p_t, relief):
    """
    Return the flow from the chamber to return, in m3/s  (C6).

    Linear above the opening pressure; below the return pressure the check valve, whose opening
    grows with the drop, returns c (P_T - p)^2 to the chamber.
    """
    if p > relief.p_open:
        return relief.slope * (p - relief.p_open)
    if p < p_t:
        return -relief.c_refill * (p_t - p) * (p_t - p)
    return 0.0


@kernel
def eased_flow(p, p_t, surplus, elastance, relief):
    """
    Return `relief_flow` as a step can follow it, in m3/s  (C10).

    On a chamber that gains ``surplus`` (m3/s) without these valves, with ``elastance`` (Pa/m3),
    the pressure decays towards the one at which both are equal. A decay faster than
    `FASTEST_RATE` has that rate: no oil is lost, and the pressure at rest is the same.
    """
    flow = relief_flow(p, p_t, relief)
    if flow == 0.0:
        return 0.0
    slope = relief.slope if flow > 0.0 else 2.0 * relief.c_refill * (p_t - p)
    rate = slope * elastance
    if rate <= FASTEST_RATE:
        return flow
    eased = surplus + (flow - surplus) * (FASTEST_RATE / rate)
    return max(0.0, eased) if flow > 0.0 else min(0.0, eased)
