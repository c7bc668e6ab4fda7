"""
The spool: its motion under the coil current, and the null bias added to that current.

``x > 0`` opens P-A and B-T and extends. Equation 8 of the paper IS the closed spool loop and
is never put inside another one; `PilotedSpool` is the same spool without its loop, which then
is a block of the REU. Currents here are on the series scale of figure 5.
"""

import math

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import choice, fault, nested, parameter, Parameters
from isa_ros.core.record import record
from isa_ros.core.units import MICRO, MILLI, MPA, PERCENT
from isa_ros.errors import ParameterError
from isa_ros.plant.response_fit import (
    damping_of, passed_at_3db, passed_at_90, SecondOrder, speed_limit)
import numpy as np

CLOSED_LOOP = 0
DIRECT = 1
PILOTED = 2
_OVERDAMPED = 5.0   # the largest damping ratio of any spool
_UNLIMITED = 1.0 - 1e-9     # of a saturation: nothing is cut off
STUCK = '1: the spool is blocked and holds its position'


@frozen(kw_only=True)
class NullBias(Parameters):
    """The current that holds the spool off its null, and its shifts."""

    current_ma: float = parameter(
        'at the reference conditions', 'mA', changeable=True, ge=-2.0, le=2.0)
    supply_ma_per_mpa: float = parameter('shift with supply pressure', 'mA/MPa', ge=-0.5, le=0.5)
    return_ma_per_mpa: float = parameter('shift with return pressure', 'mA/MPa', ge=-0.5, le=0.5)
    temperature_ua_per_k: float = parameter('shift with oil temperature', 'uA/K', ge=-50, le=50)
    reference_supply_mpa: float = parameter('reference conditions', 'MPa', gt=0.0, le=70.0)
    reference_celsius: float = parameter('reference conditions', 'celsius', ge=-30.0, le=80.0)


NO_BIAS = NullBias(
    current_ma=0.0, supply_ma_per_mpa=0.0, return_ma_per_mpa=0.0, temperature_ua_per_k=0.0,
    reference_supply_mpa=21.0, reference_celsius=40.0)


@frozen(kw_only=True)
class Spool(Parameters):
    """Parameters of every spool."""

    natural_frequency_rad_per_s: float = parameter(
        'w_n of equations 7 and 8', 'rad/s', gt=0.0, le=2.0e4)
    damping_ratio: float = parameter('zeta of equations 7 and 8', '1', gt=0.0, le=5.0)
    null_bias: NullBias
    stuck: float = fault(STUCK, '1', is_whole=True, ge=0.0, le=1.0)


@frozen(kw_only=True)
class ClosedLoopSpool(Spool):
    """Pilot stage and spool feedback in one: equation 8."""

    loop_gain_per_s: float = parameter('K_loop of equation 8', '1/s', gt=0.0, le=1.0e4)


@frozen(kw_only=True)
class DirectSpool(Spool):
    """A spool that follows the current as a second-order system: equation 7."""


@frozen(kw_only=True)
class PilotedSpool(Spool):
    """Equation 8 without its loop: the current drives the spool's speed."""

    pilot_gain_mm_per_s_per_ma: float = parameter(
        'K_pilot, spool speed per series current', 'mm/s/mA', gt=0.0, le=1.0e4)


@frozen(kw_only=True)
class DataSheetSpool(Parameters):
    """A spool that follows the current as a data sheet's frequency response: equation 7."""

    frequency_hz: float = parameter('frequency of the stated point', 'Hz', gt=0.0, le=1e3)
    at: str = choice('the stated point of the response', 'minus_3_db', 'minus_90_deg')
    damping_ratio: float = parameter('zeta of equation 7', '1', gt=0.0, le=5.0)
    null_bias: NullBias
    stuck: float = fault(STUCK, '1', is_whole=True, ge=0.0, le=1.0)

    @property
    def natural_frequency_rad_per_s(self) -> float:
        """Return w_n from the point of the response  (V17)."""
        stated = 2.0 * math.pi * self.frequency_hz
        if self.at == 'minus_90_deg':
            return stated
        damped = 1.0 - 2.0 * self.damping_ratio * self.damping_ratio
        return stated / math.sqrt(damped + math.sqrt(damped * damped + 1.0))


@frozen(kw_only=True)
class ResponseSpool(Parameters):
    """A spool with the frequency response of a data sheet at a small and a large amplitude."""

    minus_90_deg_hz: float = parameter(
        'frequency of -90 degrees at a small amplitude', 'Hz', gt=0.0, le=1e3)
    minus_3_db_hz: float = parameter(
        'frequency of -3 dB at a small amplitude', 'Hz', gt=0.0, le=1e3)
    large_percent: float = parameter(
        'large amplitude, of the current at the stop', '%', absent=90.0,
        source='assumed, as sheets', gt=0.0, le=100.0)
    large_minus_90_deg_hz: float = parameter(
        'frequency of -90 degrees at the large amplitude; 0: not stated', 'Hz', absent=0.0,
        source='assumed, not stated', ge=0.0, le=1e3)
    large_minus_3_db_hz: float = parameter(
        'frequency of -3 dB at the large amplitude; 0: not stated', 'Hz', absent=0.0,
        source='assumed, not stated', ge=0.0, le=1e3)
    null_bias: NullBias = nested(NO_BIAS)
    stuck: float = fault(STUCK, '1', is_whole=True, ge=0.0, le=1.0)

    def __post_init__(self) -> None:
        """Refuse points that no second-order spool with a limited speed has."""
        super().__post_init__()
        zeta = self.damping_ratio
        if zeta > _OVERDAMPED:
            raise ParameterError(
                f'minus_3_db_hz = {self.minus_3_db_hz:g} Hz and minus_90_deg_hz = '
                f'{self.minus_90_deg_hz:g} Hz need a damping ratio of {zeta:.3g}, must be <= '
                f'{_OVERDAMPED:g}')
        for name in ('minus_90_deg_hz', 'minus_3_db_hz'):
            small, large = getattr(self, name), getattr(self, f'large_{name}')
            if large > small:
                raise ParameterError(
                    f'large_{name} = {large:g} Hz, must be <= {name} = {small:g} Hz: a spool is '
                    'not faster at a larger amplitude')

    @property
    def natural_frequency_rad_per_s(self) -> float:
        """Return w_n, the frequency of -90 degrees  (V28)."""
        return 2.0 * math.pi * self.minus_90_deg_hz

    @property
    def damping_ratio(self) -> float:
        """Return zeta of both points  (V28)."""
        return damping_of(self.minus_90_deg_hz, self.minus_3_db_hz)

    @property
    def limit(self) -> float:
        """Return the largest speed per large amplitude, 1/s; 0: none  (V29)."""
        own = SecondOrder(self.natural_frequency_rad_per_s, self.damping_ratio)
        if self.large_minus_90_deg_hz > 0.0:
            frequency = self.large_minus_90_deg_hz
            passed = passed_at_90(own, frequency)
        elif self.large_minus_3_db_hz > 0.0:
            frequency = self.large_minus_3_db_hz
            passed = passed_at_3db(own, frequency)
        else:
            return 0.0
        return speed_limit(own, frequency, passed) if passed < _UNLIMITED else 0.0


SPOOL = np.dtype([
    ('kind', 'i8'), ('w_n', 'f8'), ('zeta', 'f8'),
    ('k_loop', 'f8'),       # 1/s
    ('k_pilot', 'f8'),      # m/s per A, series scale
    ('bias', 'f8'),         # A, series scale, temperature included
    ('bias_s', 'f8'), ('bias_t', 'f8'),     # A/Pa
    ('p_s_ref', 'f8'),      # Pa
    ('is_stuck', 'f8'),
    ('v_max', 'f8'),        # largest speed, m/s; 0: none
])
SPOOL_STATE = np.dtype([('position', 'f8'), ('velocity', 'f8'), ('acceleration', 'f8')])


def bias_per_k(sheet: Spool | DataSheetSpool | ResponseSpool) -> float:
    """Return b_theta of V12, in A/K on the series scale."""
    return sheet.null_bias.temperature_ua_per_k * MICRO


def spool_record(
        sheet: Spool | DataSheetSpool | ResponseSpool, temperature: float, travel: float = 0.0,
        shift: tuple[float, float] = (0.0, 0.0)) -> np.record:
    """
    Return the `SPOOL` record of a sheet with oil at ``temperature`` (celsius).

    ``travel`` is that at the stop, m, ``shift`` what the null shifts beside the spool's own bias
    with supply pressure (A/Pa) and temperature (A/K).
    """
    kind, k_loop, k_pilot = DIRECT, 0.0, 0.0
    if isinstance(sheet, ClosedLoopSpool):
        kind, k_loop = CLOSED_LOOP, sheet.loop_gain_per_s
    elif isinstance(sheet, PilotedSpool):
        kind, k_pilot = PILOTED, sheet.pilot_gain_mm_per_s_per_ma
    bias = sheet.null_bias
    warmer = temperature - bias.reference_celsius
    return record(
        SPOOL, kind=kind, w_n=sheet.natural_frequency_rad_per_s, zeta=sheet.damping_ratio,
        k_loop=k_loop, k_pilot=k_pilot,
        bias=bias.current_ma * MILLI + (bias_per_k(sheet) + shift[1]) * warmer,
        bias_s=bias.supply_ma_per_mpa * MILLI / MPA + shift[0],
        bias_t=bias.return_ma_per_mpa * MILLI / MPA,
        p_s_ref=bias.reference_supply_mpa * MPA, is_stuck=sheet.stuck,
        v_max=(sheet.limit * sheet.large_percent * PERCENT * travel
               if isinstance(sheet, ResponseSpool) else 0.0))


@kernel
def null_bias(p_s, p_t, spool):
    """Return i_0 + b_S (P_S - P_S0) + b_T P_T, the null bias in A, series scale  (V12)."""
    return spool.bias + spool.bias_s * (p_s - spool.p_s_ref) + spool.bias_t * p_t


@kernel
def spool_reference(current, k_spool):
    """Return K_spool i of a series-scale current (A)  (V2, equation 9), in m."""
    return k_spool * current


@kernel
def spool_jerk(reference, y, spool):
    """
    Return w_n^2 (K_loop (x_r - x) - x') - 2 zeta w_n x''  (V3), in m/s3.

    Equation 8 of the paper in the time domain; ``y`` is a `SPOOL_STATE` record.
    """
    w_n = spool.w_n
    return (w_n * w_n * (spool.k_loop * (reference - y.position) - y.velocity)
            - 2.0 * spool.zeta * w_n * y.acceleration)


@kernel
def piloted_jerk(current, y, spool):
    """Return w_n^2 (K_pilot i - x') - 2 zeta w_n x''  (V13), in m/s3: eq 8 with its loop open."""
    w_n = spool.w_n
    return (w_n * w_n * (spool.k_pilot * current - y.velocity)
            - 2.0 * spool.zeta * w_n * y.acceleration)


@kernel
def spool_acceleration(reference, spool, velocity, w_n, zeta):
    """Return w_n^2 (x_r - x) - 2 zeta w_n x'  (V10, equation 7 of the paper), in m/s2."""
    return w_n * w_n * (reference - spool) - 2.0 * zeta * w_n * velocity


@kernel
def limited_acceleration(reference, spool, velocity, own):
    """
    Return V10 with a pilot stage whose flow ends  (V29), in m/s2.

    w_n^2 (x_r - x) within +-2 zeta w_n v_max, less 2 zeta w_n x'; ``own`` is the `SPOOL` record.
    """
    damping = 2.0 * own.zeta * own.w_n
    most = damping * own.v_max
    return max(-most, min(most, own.w_n * own.w_n * (reference - spool))) - damping * velocity


@kernel
def spool_rates(y, current, k_spool, spool, rates):
    """
    Write the rates of one `SPOOL_STATE` under a series-scale current, bias included.

    A blocked spool has none: x' = 0  (V20).
    """
    if spool.is_stuck > 0.0:
        rates.position, rates.velocity, rates.acceleration = 0.0, 0.0, 0.0
        return
    rates.position = y.velocity
    if spool.kind == DIRECT:
        rates.velocity = spool_acceleration(
            spool_reference(current, k_spool), y.position, y.velocity, spool.w_n, spool.zeta)
        if spool.v_max > 0.0:
            rates.velocity = limited_acceleration(
                spool_reference(current, k_spool), y.position, y.velocity, spool)
        rates.acceleration = 0.0
        return
    rates.velocity = y.acceleration
    if spool.kind == PILOTED:
        rates.acceleration = piloted_jerk(current, y, spool)
    else:
        rates.acceleration = spool_jerk(spool_reference(current, k_spool), y, spool)


@kernel
def block_spool(y):
    """Hold the spool where it is blocked: its speed is zero at once  (V20)."""
    y.velocity = 0.0
    y.acceleration = 0.0


@kernel
def stop_spool(y, x_max):
    """Hold the spool at its mechanical stop; the impact is plastic, so its speed is zero."""
    if abs(y.position) > x_max:
        y.position = math.copysign(x_max, y.position)
        if y.velocity * y.position > 0.0:
            y.velocity = 0.0
            y.acceleration = 0.0
