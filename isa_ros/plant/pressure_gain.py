"""
Pressure gain of a servo valve: a point of its leakage, and nothing else.

With both ports shut each pair of lands divides the supply pressure; how far a current shifts the
load pressure is how much more an open land passes than a closed one. So a stated pressure gain is
the leakage of a land at that current, and contradicts another leakage there.
"""

import math

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.units import PERCENT
from isa_ros.errors import ParameterError

_HALVINGS = 60
_LEAST = 1e-3   # %; sheets state 30 to 80


@frozen(kw_only=True)
class PressureGain(Parameters):
    """The load pressure with both ports shut at a small current; 0 %: not stated."""

    current_percent: float = parameter(
        'current of the point, of the one at the stop', '%', absent=1.0,
        source='assumed, as sheets', gt=0.0, le=50.0)
    percent: float = parameter(
        'load pressure there, of the supply above return pressure; 0: not stated', '%', absent=0.0,
        source='assumed, not stated', ge=0.0, le=99.0)

    def __post_init__(self) -> None:
        """Refuse a gain of nothing, for which a land would leak without end."""
        super().__post_init__()
        if 0.0 < self.percent < _LEAST:
            raise ParameterError(
                f'percent = {self.percent:g} %, must be 0 % or >= {_LEAST:g} %')


def opened_over_closed(share: float) -> float:
    """Return rho = sqrt((1 + pi)/(1 - pi)), (g + l)/l of a load pressure of pi  (V27)."""
    return math.sqrt((1.0 + share) / (1.0 - share))


def land_leakage_at(gain: PressureGain, flow: float) -> float:
    """Return l = g/(rho - 1) of a land at the stated point; ``flow`` is g  (V27)."""
    return flow / (opened_over_closed(gain.percent * PERCENT) - 1.0)


def passed(leak: float, flow: float, root_drops: float) -> float:
    """Return what both pairs of equal lands pass with shut ports: l and g + l in series  (V16)."""
    opened = flow + leak
    if opened == 0.0:
        return 0.0
    return 2.0 * root_drops * opened * leak / math.sqrt(opened * opened + leak * leak)


def gain_of(leak: float, flow: float) -> float:
    """Return the pressure gain (%) of a land that leaks ``leak`` and opens by ``flow``  (V27)."""
    square = (1.0 + flow / leak) * (1.0 + flow / leak)
    return (square - 1.0) / (square + 1.0) / PERCENT


def _least_leak(total: float, flow: float, root_drops: float) -> float:
    """Return the leakage of a land with which both pairs pass ``total`` at ``flow``."""
    low, high = 0.0, total / root_drops     # l alone passes sqrt(2) l or more of it
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if passed(middle, flow, root_drops) < total:
            low = middle
        else:
            high = middle
    return high


def _allowed(total: float, opened: float, flow: float, root_drops: float, bound: str) -> str:
    """Return in words which gain lands have that pass ``total`` as far as they are ``opened``."""
    if total <= 0.0:
        return ', all of the pilot stage'
    gain = gain_of(_least_leak(total, opened, root_drops), flow)
    return f', with which it is {bound} {gain:.3g} %'


def refuse_contradiction(
        gain: PressureGain, flow: float, root_drops: float, current_ma: float,
        at: tuple[float, float], beyond: tuple[float, float] | None) -> None:
    """
    Refuse a pressure gain that contradicts the leakages beside it.

    ``flow`` is g at the stated current; ``at`` the leakage of the lands at null, pilot stage left
    out, and that with it, ``beyond`` the current and the first, with g there, behind the point:
    all in the unit of ``flow`` but currents (mA).

    Raises
    ------
    ParameterError
        Names both numbers, and the gain that the stated leakage allows.

    """
    leak = land_leakage_at(gain, flow)
    needed, tare = passed(leak, 0.0, root_drops), at[1] - at[0]
    stated = f'pressure_gain.percent = {gain.percent:g} % at {current_ma:g} mA'
    if needed > at[0]:
        raise ParameterError(
            f'{stated} needs a leakage of at least {needed + tare:.4g} l/min at null, and '
            f'leakage.total_lpm[0] = {at[1]:g} l/min'
            + _allowed(at[0], 0.0, flow, root_drops, '>='))
    if beyond is not None and passed(leak, beyond[1], root_drops) < beyond[0]:
        raise ParameterError(
            f'{stated} leaves at most {passed(leak, beyond[1], root_drops) + tare:.4g} l/min to '
            f'the next point, where leakage.total_lpm[1] = {beyond[0] + tare:g} l/min'
            + _allowed(beyond[0], beyond[1], flow, root_drops, '<='))
