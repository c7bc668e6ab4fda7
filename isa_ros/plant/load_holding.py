"""
Valves that hold a load, at the ports of the cylinder: what they share.

Each lets oil into its chamber through a check valve, and out of it as far as its poppet is
lifted by the pressures that its kind compares (`pilot_check`, `counterbalance`). One poppet a
line, which follows with a lag: it does not chatter faster than that. ``load`` is the pressure of
the chamber, ``line`` that of the hose, ``pilot`` that of the other hose, in Pa. Neglected: flow
forces, hysteresis, the volume of the pilot line, and the oil that a moving poppet displaces.
"""

import math

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import fault, Parameters
from isa_ros.core.record import record
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.core.units import LPM
from isa_ros.errors import ParameterError
import numpy as np

HOLDING = np.dtype([
    ('kind', 'f8'),
    ('k_in', 'f8'), ('k_out', 'f8'),            # of the whole lift, m3/s/sqrt(Pa)
    ('k_shut', 'f8'),                           # of a seated poppet and its leak
    ('crack', 'f8'), ('check_span', 'f8'),      # Pa: check valve begins to open, and beyond, open
    ('setting', 'f8'), ('span', 'f8'),          # Pa: poppet begins to open, and beyond, open
    ('ratio', 'f8'),                            # of the areas of pilot and seat
    ('line_share', 'f8'),                       # of the line's pressure against the pilot
    ('lag', 'f8'),                              # of the lift, s
    ('is_stuck_open', 'f8'), ('is_stuck_shut', 'f8')])
NO_HOLDING, PILOT_CHECK, COUNTERBALANCE = 0.0, 1.0, 2.0

LEAKAGE_DROP = 21e6     # Pa at which leakages are stated
FASTEST_SWING = 0.5     # rad in a step: a poppet on the oil that it lets out
_SHUT = 1e-15           # m3/s/sqrt(Pa), some 1e-7 ml/min: no flow


@frozen(kw_only=True)
class NoneHolding(Parameters):
    """The hose ends at the chamber."""


@frozen(kw_only=True)
class PoppetFaults(Parameters):
    """What can go wrong with a valve that holds a load."""

    stuck_open: float = fault('1: its poppet is stuck open', '1', is_whole=True, ge=0.0, le=1.0)
    stuck_shut: float = fault('1: its poppet is stuck shut', '1', is_whole=True, ge=0.0, le=1.0)
    leaking_lpm: float = fault(
        'of its damaged seat at 21 MPa, beyond the leakage', 'l/min', ge=0.0, le=100.0)
    spring_broken: float = fault('1: its spring is broken', '1', is_whole=True, ge=0.0, le=1.0)

    def __post_init__(self) -> None:
        """Refuse a poppet that is stuck in two places."""
        super().__post_init__()
        if self.stuck_open and self.stuck_shut:
            raise ParameterError('stuck_open = 1 and stuck_shut = 1, must not both be 1')


def no_holding() -> np.record:
    """Return the `HOLDING` record of a line without such a valve."""
    return record(HOLDING, **dict.fromkeys(HOLDING.names or (), 0.0))


def conductance(flow_lpm: float, drop: float) -> float:
    """Return K = Q/sqrt(dP) of a flow (l/min) at a drop (Pa), in m3/s/sqrt(Pa)."""
    return flow_lpm * LPM / math.sqrt(drop)


def least_lag(holding: np.record, at_chamber: float, at_hose: float, pressure: float) -> float:
    """
    Return the least lag in s with which a step resolves a poppet on its oil.

    ``at_chamber`` and ``at_hose`` are elastances, Pa/m3; ``pressure`` is the largest drop, Pa. A
    lift lets out k sqrt(P), which moves the pressures that lift it: w^2 = gain/lag, with w no
    faster than `FASTEST_SWING`.
    """
    out = holding.k_out * math.sqrt(pressure) / holding.span
    into = holding.k_in * math.sqrt(holding.crack + holding.check_span) / holding.check_span
    gain = max(out * (at_chamber + (1.0 + holding.ratio) * at_hose),
               into * (at_chamber + at_hose))
    slowest = PLANT_STEP / FASTEST_SWING
    return float(gain * slowest * slowest)


@kernel
def poppet_square(drop, lift, holding):
    """
    Return 1/K^2 of a valve with its poppet at a lift, in Pa s2/m6; -1: it is shut  (V41).

    ``drop`` > 0 drives oil into the chamber, through the check valve; K grows with the lift.
    """
    whole = holding.k_in if drop > 0.0 else holding.k_out
    k = holding.k_shut + lift * max(0.0, whole - holding.k_shut)
    return 1.0 / (k * k) if k > _SHUT else -1.0


@kernel
def lift_rate(lift, excess, load, line, holding):
    """
    Return the rate of the lift, 1/s  (V40).

    ``excess`` is by how much the pressures exceed what opens the poppet against the load, in Pa;
    a pressure of the line above that of the load lifts it as a check valve.
    """
    by_check = (line - load - holding.crack) / holding.check_span
    by_pilot = excess / holding.span
    if holding.is_stuck_shut > 0.0:
        # the check valve of a counterbalance valve is a poppet of its own
        by_pilot = 0.0
        if holding.kind == PILOT_CHECK:
            by_check = 0.0
    target = min(1.0, max(0.0, by_check, by_pilot))
    if holding.is_stuck_open > 0.0:
        target = 1.0
    return (target - lift) / holding.lag
