"""
Pilot-operated check valve: shuts a chamber until the pressure of the other line opens it.

Signs and what is neglected: `load_holding`. It is open or shut: with a falling load the pilot's
pressure breaks down, the valve shuts, and the load comes down in jerks.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import choice, parameter
from isa_ros.core.record import record
from isa_ros.core.units import MILLI, MPA
from isa_ros.plant.load_holding import (
    conductance, HOLDING, LEAKAGE_DROP, PILOT_CHECK, PoppetFaults)
import numpy as np


@frozen(kw_only=True)
class PilotCheckHolding(PoppetFaults):
    """A check valve whose poppet a piston lifts."""

    pilot_ratio: float = parameter('area of the pilot piston over that of the seat', '1',
                                   gt=0.0, le=50.0)
    cracking_mpa: float = parameter('at which its spring lets oil in', 'MPa', ge=0.0, le=5.0)
    opening_mpa: float = parameter(
        'beyond that, to the whole lift', 'MPa', absent=0.2, source='assumed, a soft spring',
        ge=0.01, le=20.0)
    rated_lpm: float = parameter('flow of the whole lift', 'l/min', gt=0.0, le=1e4)
    rated_drop_mpa: float = parameter('drop at this flow', 'MPa', gt=0.0, le=20.0)
    leakage_lpm: float = parameter(
        'of the shut valve at 21 MPa', 'l/min', absent=2.5e-4,
        source='assumed, five drops a minute', ge=0.0, le=1.0)
    lag_ms: float = parameter(
        'of its poppet', 'ms', absent=5.0, source='assumed', ge=0.1, le=1e3)
    drain: str = choice(
        'line: the pressure of its own line is behind the pilot piston; outside: none is', 'line',
        'outside', absent='line', source='assumed')


def pilot_check_record(sheet: PilotCheckHolding) -> np.record:
    """Return the `HOLDING` record of a sheet."""
    rated = conductance(sheet.rated_lpm, sheet.rated_drop_mpa * MPA)
    crack = 0.0 if sheet.spring_broken else sheet.cracking_mpa * MPA
    return record(
        HOLDING, kind=PILOT_CHECK, k_in=rated, k_out=rated,
        k_shut=conductance(sheet.leakage_lpm + sheet.leaking_lpm, LEAKAGE_DROP),
        crack=crack, check_span=sheet.opening_mpa * MPA, setting=crack,
        span=sheet.opening_mpa * MPA, ratio=sheet.pilot_ratio,
        line_share=1.0 if sheet.drain == 'line' else 0.0, lag=sheet.lag_ms * MILLI,
        is_stuck_open=sheet.stuck_open, is_stuck_shut=sheet.stuck_shut)


@kernel
def pilot_check_excess(load, line, pilot, holding):
    """
    Return R (P_x - d P_v) - (P_c - P_v) - P_crack, in Pa  (V42).

    P_x of the pilot, P_v of the line, P_c of the load, R the ratio, d the ``line_share``.
    """
    return (holding.ratio * (pilot - holding.line_share * line) - (load - line)
            - holding.setting)
