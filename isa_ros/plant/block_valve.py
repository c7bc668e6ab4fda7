"""
Block valves: a two-way poppet in each service line, between servo valve and chamber.

They are in both lines, not in the supply's: there one would leave a stuck spool open to the
return, and the load would push its oil out. One solenoid holds both open; without current a
spring closes them. Flows are positive INTO the chamber. Relief and refill valves are on the
chamber's side, so that a stopped mass cannot burst it. The oil between servo valve and poppet is
neglected: what flows through the lands flows through the poppet.
"""

import math

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.orifice import root_slope, signed_sqrt
from isa_ros.core.parameter import choice, fault, parameter, Parameters
from isa_ros.core.record import record
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.core.units import LPM, MILLI, MPA
from isa_ros.plant.servo_valve import smoothing
import numpy as np

WHEN_OFF = 'when_off'


@frozen(kw_only=True)
class NoneBlock(Parameters):
    """The service lines go from the servo valve straight to the chambers."""


@frozen(kw_only=True)
class PoppetBlock(Parameters):
    """A poppet in each service line, which a spring closes and one solenoid for both opens."""

    closes: str = choice(
        'when_off: whenever the outputs are off; by_reaction: by a trip with the reaction block, '
        'and by the emergency stop', WHEN_OFF, 'by_reaction', absent=WHEN_OFF, source='assumed')
    rated_lpm: float = parameter(
        'flow of an open poppet at the rated drop', 'l/min', absent=30.0,
        source='assumed, a size 8 cartridge', gt=0.0, le=1000.0)
    rated_drop_mpa: float = parameter(
        'pressure drop at the rated flow', 'MPa', absent=0.7, source='assumed, likewise',
        gt=0.0, le=10.0)
    leakage_lpm: float = parameter(
        'of a closed poppet at 21 MPa', 'l/min', absent=2.5e-4,
        source='assumed, five drops a minute', ge=0.0, le=1.0)
    delay_ms: float = parameter(
        'from a switch of the current to the begin of the motion', 'ms', absent=10.0,
        source='assumed, the decay of the coil', ge=0.0, le=1e3)
    opening_ms: float = parameter(
        'of the whole lift', 'ms', absent=20.0, source='assumed', gt=0.0, le=1e3)
    closing_ms: float = parameter(
        'of the whole lift', 'ms', absent=20.0, source='assumed', gt=0.0, le=1e3)
    stuck: float = fault(
        '1: both poppets are blocked and hold their lift', '1', is_whole=True, ge=0.0, le=1.0)


BLOCK = np.dtype([
    ('is_on', 'f8'),                            # 1: there are block valves
    ('k_open', 'f8'), ('k_closed', 'f8'),       # m3/s/sqrt(Pa)
    ('delay', 'f8'),                            # s
    ('opens', 'f8'), ('closes', 'f8'),          # of the lift, 1/s
    ('is_stuck', 'f8'),
    ('slew', 'f8')])                            # of the lift over this plant step, 1/s
BLOCK_STATE = np.dtype([('lift', 'f8')])        # of both poppets: 0 closed, 1 open

_LEAKAGE_DROP = 21e6    # Pa at which `leakage_lpm` is stated
_MOST_STEPS = 60        # bisection alone halves any bracket down to its rounding
_CLOSE = 1e-13          # of the pressures: about their last digits


def block_record(sheet: NoneBlock | PoppetBlock) -> np.record:
    """Return the `BLOCK` record of a sheet."""
    if isinstance(sheet, NoneBlock):
        return record(BLOCK, is_on=0.0, k_open=0.0, k_closed=0.0, delay=0.0, opens=0.0,
                      closes=0.0, is_stuck=0.0, slew=0.0)
    return record(
        BLOCK, is_on=1.0,
        k_open=sheet.rated_lpm * LPM / math.sqrt(sheet.rated_drop_mpa * MPA),
        k_closed=sheet.leakage_lpm * LPM / math.sqrt(_LEAKAGE_DROP),
        delay=sheet.delay_ms * MILLI, opens=1e3 / sheet.opening_ms,
        closes=1e3 / sheet.closing_ms, is_stuck=sheet.stuck, slew=0.0)


def time_to_open(sheet: NoneBlock | PoppetBlock) -> float:
    """Return the time from the current to the whole lift, s; 0 without block valves."""
    if isinstance(sheet, NoneBlock):
        return 0.0
    return (sheet.delay_ms + sheet.opening_ms) * MILLI


@kernel
def drive_block(is_energised, since, lift, block):
    """
    Write the slew of the lift over a plant step, in 1/s  (V21).

    ``since`` is the time since the current was switched on or off, s: the poppets move after the
    delay, with constant speed, until they are at their seat or stop.
    """
    block.slew = 0.0
    if since < block.delay or block.is_stuck > 0.0:
        return
    if is_energised:
        block.slew = min(block.opens, (1.0 - lift) / PLANT_STEP)
    else:
        block.slew = -min(block.closes, lift / PLANT_STEP)


@kernel
def poppet_conductance(lift, block):
    """Return K_b, from that of the closed poppet to the open one's, in m3/s/sqrt(Pa)  (V21)."""
    return block.k_closed + lift * (block.k_open - block.k_closed)


@kernel
def in_series(k_1, k_2):
    """Return K_1 K_2/sqrt(K_1^2 + K_2^2), the conductance of two orifices in series."""
    squares = k_1 * k_1 + k_2 * k_2
    return k_1 * k_2 / math.sqrt(squares) if squares > 0.0 else 0.0


@kernel
def line_pressure(k_s, k_t, k_b, p_s, p_t, p, delta):
    """
    Return P', the pressure between servo valve and poppet, in Pa  (V22).

    It solves K_s S(P_S - P') - K_t S(P' - P_T) = K_b S(P' - P), of which the left less the right
    side falls with P': by Newton's method, which bisects where it would leave the bracket. The
    lands have ``k_s`` to the supply and ``k_t`` to the return, the chamber the pressure ``p``.
    Where all three are shut, P' is that of the chamber.
    """
    low, high = min(p, p_s, p_t), max(p, p_s, p_t)
    squares = k_s * k_s + k_t * k_t + k_b * k_b
    if squares == 0.0:
        return p
    at = (k_s * k_s * p_s + k_t * k_t * p_t + k_b * k_b * p) / squares
    close = _CLOSE * max(abs(low), abs(high), delta)
    for _ in range(_MOST_STEPS):
        excess = (k_s * signed_sqrt(p_s - at, delta) - k_t * signed_sqrt(at - p_t, delta)
                  - k_b * signed_sqrt(at - p, delta))
        if excess > 0.0:
            low = at
        else:
            high = at
        newton = at + excess / (
            k_s * root_slope(p_s - at, delta) + k_t * root_slope(at - p_t, delta)
            + k_b * root_slope(at - p, delta))
        if not low <= newton <= high:
            newton = 0.5 * (low + high)
        moved, at = abs(newton - at), newton
        if moved <= close:
            break
    return at


@kernel
def blocked_line(k_s, k_t, lift, p_s, p_t, p, elastance, smallest, block):
    """
    Return P' of a service line, and the delta of V5 for it, both in Pa  (V22, V18).

    That of V18 is for the poppet in series with the lands, on a chamber of ``elastance`` (Pa/m3);
    ``smallest`` is the sheet's.
    """
    k_b = poppet_conductance(lift, block)
    delta = smoothing(in_series(k_s + k_t, k_b), elastance, smallest)
    return line_pressure(k_s, k_t, k_b, p_s, p_t, p, delta), delta
