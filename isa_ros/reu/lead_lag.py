"""
The current block: PID with second-order lead-lag, two degrees of freedom.

Equations 1 and 2 of the paper. It commands the amplifier's voltage (V) from the amplifier's
current (A); the gain on the demand replaces an integral, without its phase lag.
"""

import math

from isa_ros.core.elementary import cos, sin
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import choice, parameter, tunable
from isa_ros.core.record import record
from isa_ros.errors import ParameterError
from isa_ros.reu.dither import Dithered
from isa_ros.reu.filters import low_pass, low_pass_coefficient
import numpy as np


@frozen(kw_only=True)
class LeadLag(Dithered):
    """Gains of the current loop."""

    kp_v_per_ma: float = tunable('K_p of equation 1', 'V/mA', named='kp', gt=0.0, le=1e3)
    kpf: float = tunable('K_pf on the demand (eq 2)', '1', gt=0.0, le=1e6)
    lead_rad_per_s: float = tunable('w_lead', 'rad/s', named='lead', gt=0.0, le=1e6)
    lag_rad_per_s: float = tunable('w_lag', 'rad/s', named='lag', gt=0.0, le=1e6)
    lead_damping: float = tunable('zeta_lead', '1', gt=0.0, le=2.0)
    lag_damping: float = tunable('zeta_lag', '1', gt=0.0, le=2.0)
    ki_v_per_ma_s: float = tunable('integral gain K_i', 'V/(mA s)', named='ki', ge=0.0, le=1e6)
    kd_v_s_per_ma: float = tunable('derivative gain K_d', 'V s/mA', named='kd', ge=0.0, le=10.0)
    derivative_filter_hz: float = parameter('low-pass on the derivative', 'Hz', ge=1e-3, le=25e3)
    offset_v: float = tunable('added to the voltage', 'V', named='offset', ge=-100.0, le=100.0)
    limit_v: float = tunable('largest voltage', 'V', named='limit', gt=0.0, le=100.0)
    anti_windup: str = choice(
        'clamped: the integral is held while the voltage is saturated', 'clamped', 'none')

    def __post_init__(self) -> None:
        """Refuse a notch that the loop's samples cannot have."""
        super().__post_init__()
        highest = math.pi * self.rate_hz
        if self.lead_rad_per_s >= highest:
            raise ParameterError(
                f'lead_rad_per_s = {self.lead_rad_per_s:g} rad/s, must be < {highest:g} rad/s, '
                f'half of rate_hz = {self.rate_hz:g} Hz')


LEAD_LAG = np.dtype([
    ('period', 'f8'), ('kpf', 'f8'), ('ki', 'f8'), ('kd', 'f8'), ('derivative_alpha', 'f8'),
    ('offset', 'f8'), ('limit', 'f8'), ('is_clamped', 'f8'),
    ('b_0', 'f8'), ('b_1', 'f8'), ('b_2', 'f8'), ('a_1', 'f8'), ('a_2', 'f8')])
LEAD_LAG_STATE = np.dtype([
    ('z_1', 'f8'), ('z_2', 'f8'), ('integral', 'f8'), ('error', 'f8'), ('error_rate', 'f8')])


def demand_gain(kp: float, static_gain: float) -> float:
    """Return K_pf = (1 + K_p K_sg)/(K_p K_sg)  (R10, equation 2); ``kp`` V/A, K_sg A/V."""
    return (1.0 + kp * static_gain) / (kp * static_gain)


def lead_lag_record(sheet: LeadLag) -> np.record:
    """
    Return the `LEAD_LAG` record of a sheet: C(s) by Tustin, s = c (z - 1)/(z + 1)  (R9).

    C(s) = K_p w_lag^2 (s^2 + 2 zeta_lead w_lead s + w_lead^2)
    / (w_lead^2 (s^2 + 2 zeta_lag w_lag s + w_lag^2)), equation 1, prewarped at the notch with
    c = w_lead/tan(w_lead T/2), so that the notch is at w_lead.
    """
    half = 0.5 * sheet.lead_rad_per_s / sheet.rate_hz
    c = sheet.lead_rad_per_s * cos(half) / sin(half)

    def quadratic(w: float, zeta: float) -> tuple[float, float, float]:
        s2, s1, s0 = c * c, 2.0 * zeta * w * c, w * w
        return s2 + s1 + s0, 2.0 * (s0 - s2), s2 - s1 + s0
    lead_0, lead_1, lead_2 = quadratic(sheet.lead_rad_per_s, sheet.lead_damping)
    lag_0, lag_1, lag_2 = quadratic(sheet.lag_rad_per_s, sheet.lag_damping)
    ratio = sheet.lag_rad_per_s / sheet.lead_rad_per_s
    gain = sheet.kp_v_per_ma * 1e3 * ratio * ratio / lag_0
    return record(
        LEAD_LAG, period=1.0 / sheet.rate_hz, kpf=sheet.kpf, ki=sheet.ki_v_per_ma_s * 1e3,
        kd=sheet.kd_v_s_per_ma * 1e3,
        derivative_alpha=low_pass_coefficient(sheet.derivative_filter_hz, sheet.rate_hz),
        offset=sheet.offset_v, limit=sheet.limit_v,
        is_clamped=float(sheet.anti_windup == 'clamped'),
        b_0=gain * lead_0, b_1=gain * lead_1, b_2=gain * lead_2,
        a_1=lag_1 / lag_0, a_2=lag_2 / lag_0)


@kernel
def lead_lag_step(reference, measured, loop, state):
    """
    Return the voltage of one period, saturated, in V  (R9).

    U = C(z) [K_pf i_r - i] + I + K_d e' + U_0 with I' = K_i e, e = i_r - i; anti-windup as
    in R5. The paper's loop has C alone.
    """
    e = loop.kpf * reference - measured
    lead_lag = loop.b_0 * e + state.z_1
    state.z_1 = loop.b_1 * e - loop.a_1 * lead_lag + state.z_2
    state.z_2 = loop.b_2 * e - loop.a_2 * lead_lag

    error = reference - measured
    rate = (error - state.error) / loop.period
    state.error_rate = low_pass(state.error_rate, rate, loop.derivative_alpha)
    state.error = error
    wanted = lead_lag + state.integral + loop.kd * state.error_rate + loop.offset
    voltage = max(-loop.limit, min(loop.limit, wanted))
    if voltage == wanted or error * wanted < 0.0 or loop.is_clamped == 0.0:
        state.integral += loop.ki * loop.period * error
    return voltage
