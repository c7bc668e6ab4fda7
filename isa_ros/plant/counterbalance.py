"""
Counterbalance valve: holds a load, and lets it down as the other line's pressure asks for it.

A relief valve at the chamber, set above the load's pressure, that the pilot opens the further the
higher its pressure is; a check valve lets oil in past it. Signs and what is neglected:
`load_holding`.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import choice, parameter
from isa_ros.core.record import record
from isa_ros.core.units import MILLI, MPA
from isa_ros.plant.load_holding import (
    conductance, COUNTERBALANCE, HOLDING, LEAKAGE_DROP, PoppetFaults)
import numpy as np


@frozen(kw_only=True)
class CounterbalanceHolding(PoppetFaults):
    """A relief valve with a pilot, and a check valve past it."""

    pilot_ratio: float = parameter('of pilot over relief area', '1', ge=0.0, le=50.0)
    setting_mpa: float = parameter(
        'pressure of the load that opens it without pilot and back pressure', 'MPa', gt=0.0,
        le=100.0)
    opening_mpa: float = parameter(
        'beyond the setting, to the whole lift', 'MPa', ge=0.01, le=50.0)
    rated_lpm: float = parameter('flow of the whole lift', 'l/min', gt=0.0, le=1e4)
    rated_drop_mpa: float = parameter('drop at this flow', 'MPa', gt=0.0, le=70.0)
    check_cracking_mpa: float = parameter(
        'at which the check valve opens', 'MPa', absent=0.15, source='assumed', ge=0.0, le=5.0)
    check_opening_mpa: float = parameter(
        'beyond that, to its whole lift', 'MPa', absent=0.2, source='assumed', ge=0.01, le=20.0)
    check_rated_lpm: float = parameter('flow of the check valve', 'l/min', gt=0.0, le=1e4)
    check_rated_drop_mpa: float = parameter('drop at this flow', 'MPa', gt=0.0, le=20.0)
    leakage_lpm: float = parameter(
        'of the shut valve at 21 MPa', 'l/min', absent=2.5e-4,
        source='assumed, five drops a minute', ge=0.0, le=1.0)
    lag_ms: float = parameter(
        'of its poppets', 'ms', absent=5.0, source='assumed', ge=0.1, le=1e3)
    spring_chamber: str = choice(
        "line: the line's back pressure shuts it with relief and pilot area; vented: it does "
        'not act', 'line', 'vented', absent='line', source='assumed, three ports')


def counterbalance_record(sheet: CounterbalanceHolding) -> np.record:
    """Return the `HOLDING` record of a sheet."""
    return record(
        HOLDING, kind=COUNTERBALANCE,
        k_in=conductance(sheet.check_rated_lpm, sheet.check_rated_drop_mpa * MPA),
        k_out=conductance(sheet.rated_lpm, sheet.rated_drop_mpa * MPA),
        k_shut=conductance(sheet.leakage_lpm + sheet.leaking_lpm, LEAKAGE_DROP),
        crack=sheet.check_cracking_mpa * MPA, check_span=sheet.check_opening_mpa * MPA,
        setting=0.0 if sheet.spring_broken else sheet.setting_mpa * MPA,
        span=sheet.opening_mpa * MPA, ratio=sheet.pilot_ratio,
        line_share=1.0 if sheet.spring_chamber == 'line' else 0.0, lag=sheet.lag_ms * MILLI,
        is_stuck_open=sheet.stuck_open, is_stuck_shut=sheet.stuck_shut)


@kernel
def counterbalance_excess(load, line, pilot, holding):
    """
    Return P_c + R P_x - d (1 + R) P_v - P_set, in Pa  (V43).

    P_c of the load, P_x of the pilot, P_v of the line, R the ratio, d the ``line_share``.
    """
    return (load + holding.ratio * pilot
            - holding.line_share * (1.0 + holding.ratio) * line - holding.setting)
