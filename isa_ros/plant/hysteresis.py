"""
Hysteresis and threshold of the servo valve: from the coil's current to the one that moves it.

Friction holds the armature and the spool back within a play as wide as the threshold; behind it
four plays of little weight are the magnetic part. The loop of the rated current is as wide as the
sheet says, a small one hardly wider than the threshold, and how fast the current goes makes no
difference. Currents are on the series scale of figure 5, before the null bias; percentages are
those of the current at the spool's stop, one side, as data sheets have them.
Neglected: that a valve at rest creeps, and that a ripple of the oil takes hysteresis away.
"""

import math
from typing import Any, Protocol

from isa_ros.core.elementary import atan2
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter
from isa_ros.core.record import record
from isa_ros.core.units import PERCENT
from isa_ros.errors import ParameterError
import numpy as np

_PLAYS = 4      # of the magnetic part: at 5 % of the current 3 make 2 % more of a loop, 8 none


class Hysteretic(Protocol):
    """Sheet of a valve with hysteresis, in percent of the current at the spool's stop."""

    @property
    def hysteresis_percent(self) -> float:
        """Return H."""
        ...

    @property
    def threshold_percent(self) -> float:
        """Return T."""
        ...

    @property
    def hysteresis_from_percent(self) -> float:
        """Return 2 R, from which amplitude on a loop is as wide as H."""
        ...


def widest() -> Any:
    """Declare H of V24."""
    return parameter(
        'widest difference of two currents for one opening, over a slow cycle of the whole '
        'current', '%', absent=0.0, source='assumed, neglected', changeable=True, ge=0.0, le=20.0)


def threshold() -> Any:
    """Declare T of V24."""
    return parameter(
        'change of the current after a reversal until the spool moves back', '%', absent=0.0,
        source='assumed, neglected', changeable=True, ge=0.0, le=20.0)


def widest_from() -> Any:
    """Declare 2 R of V24."""
    return parameter(
        'amplitude from which a loop is as wide as stated', '%', absent=20.0,
        source='derived from a public bench record: at 20 % as wide as at 100 %', ge=1.0, le=200.0)


def refuse_hysteresis(sheet: Hysteretic) -> None:
    """
    Refuse a hysteresis below the threshold, and one that its amplitude cannot have.

    Raises
    ------
    ParameterError
        With both numbers.

    """
    most, least = sheet.hysteresis_percent, sheet.threshold_percent
    if most < least:
        raise ParameterError(
            f'hysteresis_percent = {most:g} %, must be >= threshold_percent = '
            f'{least:g} %: the threshold is part of it')
    bound = least + 0.5 * sheet.hysteresis_from_percent
    if most > bound:
        raise ParameterError(
            f'hysteresis_percent = {most:g} %, must be <= {bound:g} %, threshold_percent and '
            f'half of hysteresis_from_percent = {sheet.hysteresis_from_percent:g} %')


PLAYS = np.dtype([
    ('held', 'f8'), ('p_1', 'f8'), ('p_2', 'f8'), ('p_3', 'f8'), ('p_4', 'f8')])
"""Outputs of the plays, A: where the valve was last."""
HYSTERESIS = np.dtype([
    ('is_on', 'f8'),
    ('half', 'f8'),         # of the threshold, A
    ('share', 'f8'),        # W, of the current in the plays behind it
    ('r_1', 'f8'), ('r_2', 'f8'), ('r_3', 'f8'), ('r_4', 'f8'),     # their half widths, A
    ('plays', PLAYS),       # during a tick; between ticks they are a row of the memory
])


def hysteresis_record(sheet: Hysteretic, rated: float) -> np.record:
    """Return the `HYSTERESIS` record of a valve with the ``rated`` current (A) at its stop."""
    most, least = sheet.hysteresis_percent, sheet.threshold_percent
    reach = 0.5 * sheet.hysteresis_from_percent     # R of V24, in percent
    halves = {f'r_{j + 1}': (j + 0.5) / _PLAYS * reach * PERCENT * rated for j in range(_PLAYS)}
    return record(
        HYSTERESIS, is_on=float(most > 0.0), half=0.5 * least * PERCENT * rated,
        share=(most - least) / reach, plays=np.zeros(1, PLAYS)[0], **halves)


def widest_play(own: np.record) -> float:
    """Return H/2, how far the valve's current is at most from the coil's, A."""
    return float(own.half + own.share * 0.25 * (own.r_1 + own.r_2 + own.r_3 + own.r_4))


def passed_by_play(half: float, amplitude: float) -> complex:
    """Return the describing function of a play for a sine, N_r(A)  (V31); 0 within the play."""
    if half >= amplitude:
        return 0j
    share = 1.0 - 2.0 * half / amplitude
    across = math.sqrt(1.0 - share * share)
    return complex(0.5 + (atan2(share, across) + share * across) / math.pi,
                   -across * across / math.pi)


def passed_of_sine(sheet: Hysteretic, percent: float) -> complex:
    """
    Return what the valve makes of a sine of the current, its first harmonic over it  (V31).

    ``percent`` is the amplitude, of the current at the stop. A play behind another one is one of
    both half widths, so that those of V24 add up.
    """
    reach, half = 0.5 * sheet.hysteresis_from_percent, 0.5 * sheet.threshold_percent
    share = (sheet.hysteresis_percent - sheet.threshold_percent) / reach
    passed = (1.0 - share) * passed_by_play(half, percent)
    for j in range(_PLAYS):
        passed += share / _PLAYS * passed_by_play(half + (j + 0.5) / _PLAYS * reach, percent)
    return passed


@kernel
def play(u, held, half):
    """Return what a play of half width ``half`` at ``held`` passes on of ``u``, in A  (V23)."""
    return min(max(held, u - half), u + half)


@kernel
def magnetised(current, own):
    """
    Return the current that moves the valve, A; ``own`` is a `HYSTERESIS` record  (V24).

    u = P_{T/2}(i), i_h = u + W (mean of P_{r_j}(u) - u), r_j = (j - 1/2)/4 R, W = (H - T)/R. The
    mean of both branches is i. The plays are those of the step's begin, at each of its stages.
    """
    at = own.plays
    u = play(current, at.held, own.half)
    total = (play(u, at.p_1, own.r_1) + play(u, at.p_2, own.r_2)
             + play(u, at.p_3, own.r_3) + play(u, at.p_4, own.r_4))
    return u + own.share * (0.25 * total - u)


@kernel
def remember(current, own):
    """Move the plays to the current (A) with which a step has ended  (V25)."""
    at = own.plays
    u = play(current, at.held, own.half)
    at.held = u
    at.p_1 = play(u, at.p_1, own.r_1)
    at.p_2 = play(u, at.p_2, own.r_2)
    at.p_3 = play(u, at.p_3, own.r_3)
    at.p_4 = play(u, at.p_4, own.r_4)


@kernel
def copy_plays(source, target):
    """Copy the plays of one `PLAYS` row to another."""
    target.held, target.p_1, target.p_2 = source.held, source.p_1, source.p_2
    target.p_3, target.p_4 = source.p_3, source.p_4
