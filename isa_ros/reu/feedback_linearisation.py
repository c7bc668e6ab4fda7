"""
Force block by feedback linearisation: the valve opening that gives the wanted force rate.

Inverts the continuity equations and the flow curve with the measured pressures, position and
speed, so that the force follows its reference as a first-order system wherever the piston is.
Its output commands the spool (m) or the series-scale current (A). After the model-based force
control of Boaventura et al. 2015, which the paper names as future work.
"""

import math

from isa_ros.core.elementary import log
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import choice, parameter, Parameters, tunable
from isa_ros.core.piecewise import LINES, x_on_lines
from isa_ros.core.record import record
from isa_ros.reu.filters import low_pass, low_pass_coefficient
import numpy as np


@frozen(kw_only=True)
class FeedbackLinearisation(Parameters):
    """Wanted dynamics of the force, and the values the block's model assumes."""

    rate_hz: float = parameter('loop rate', 'Hz', gt=0.0, le=50e3)
    bandwidth_rad_per_s: float = tunable(
        'pole of the force on its reference', 'rad/s', named='bandwidth', gt=0.0, le=1e4)
    ki_per_s2: float = tunable('integral of the force error', '1/s2', named='ki', ge=0.0, le=1e7)
    kf: float = tunable('force damping K_f', 's', ge=0.0, le=0.1)
    derivative_filter_hz: float = parameter('low-pass on dF/dt', 'Hz', ge=1e-3, le=25e3)
    velocity_share: float = tunable(
        'share of the swept flow that is compensated', '1', ge=0.0, le=1.5)
    least_drop_kpa: float = tunable(
        'smallest pressure drop over a land that the model uses', 'kPa', named='least_drop',
        gt=0.0, le=5e3)
    supply_pressure_mpa: float = tunable(
        'assumed gauge supply pressure', 'MPa', named='supply_pressure', gt=0.0, le=70.0)
    return_pressure_mpa: float = tunable(
        'assumed gauge return pressure', 'MPa', named='return_pressure', ge=0.0, le=5.0)
    limit: float = tunable('largest output', 'm | A', gt=0.0, le=1.0)
    anti_windup: str = choice(
        'clamped: the integral is held while the output is saturated', 'clamped', 'none')


LINEARISED = np.dtype([
    ('area_a', 'f8'), ('area_b', 'f8'), ('stroke', 'f8'), ('dead_volume', 'f8'),
    ('beta', 'f8'), ('c_li', 'f8'), ('k_s', 'f8'),
    ('k_low', 'f8'), ('k_high', 'f8'), ('q_rest', 'f8'), ('x_dg', 'f8'), ('x_max', 'f8'),
    ('per_root_drop', 'f8'), ('f_pa', 'f8'), ('f_at', 'f8'), ('f_bt', 'f8'), ('f_pb', 'f8'),
    ('output_per_spool', 'f8'), ('has_points', 'f8'), ('flow', LINES)])
"""The block's model of the actuator, SI; names as in the plant's records."""

LINEARISATION = np.dtype([
    ('period', 'f8'), ('bandwidth', 'f8'), ('ki', 'f8'), ('kf', 'f8'),
    ('derivative_alpha', 'f8'), ('speed_alpha', 'f8'), ('velocity_share', 'f8'),
    ('least_drop', 'f8'),
    ('p_s', 'f8'), ('p_t', 'f8'), ('limit', 'f8'), ('is_clamped', 'f8'),
    ('model', LINEARISED)])


def linearisation_record(
        sheet: FeedbackLinearisation, speed_filter_hz: float, model: np.record) -> np.record:
    """
    Return the `LINEARISATION` record of a sheet; ``model`` is its `LINEARISED` record.

    ``speed_filter_hz`` is the low-pass on the speed estimate that the block receives.
    """
    return record(
        LINEARISATION, period=1.0 / sheet.rate_hz, bandwidth=sheet.bandwidth_rad_per_s,
        ki=sheet.ki_per_s2, kf=sheet.kf,
        derivative_alpha=low_pass_coefficient(sheet.derivative_filter_hz, sheet.rate_hz),
        speed_alpha=low_pass_coefficient(speed_filter_hz, sheet.rate_hz),
        velocity_share=sheet.velocity_share, least_drop=sheet.least_drop_kpa * 1e3,
        p_s=sheet.supply_pressure_mpa * 1e6, p_t=sheet.return_pressure_mpa * 1e6,
        limit=min(sheet.limit, model.x_max * model.output_per_spool),
        is_clamped=float(sheet.anti_windup == 'clamped'), model=model)


@kernel
def opening_of(flow, model):
    """
    Return the opening u >= 0 (m) at which a land gives ``flow`` >= 0 at dp_ref  (R11).

    The inverse of the flow curve (V4, V15), up to the spool's stop.
    """
    if model.has_points > 0.0:
        return min(model.x_max, x_on_lines(flow, model.flow))
    at_knee = model.k_low * model.x_dg
    if flow <= at_knee:
        return flow / model.k_low
    if model.q_rest > 0.0:
        left = 1.0 - (flow - at_knee) / model.q_rest
        if left <= 0.0:
            return model.x_max
        return min(model.x_max, model.x_dg - log(left) * model.q_rest / model.k_low)
    return min(model.x_max, model.x_dg + (flow - at_knee) / model.k_high)


@kernel
def opening_for(force_rate, measured, load_velocity, block):
    """
    Return the spool travel (m) that gives ``force_rate`` (N/s | Nm/s)  (R12).

    From C2 and C3 F' = beta [(A_A/V_A Q_A - A_B/V_B Q_B) - (A_A^2/V_A + A_B^2/V_B) v
    - (A_A/V_A + A_B/V_B) C_li (P_A - P_B)], where the piston moves with the load and with the
    sensor's deflection, v = v_load + F'/K_s; solved for the flow g of the open lands at
    dp_ref (V7) with the measured pressures. Leakage of the lands is neglected.
    """
    model = block.model
    place = max(0.0, min(model.stroke, measured.position))
    a_a, a_b = model.area_a, model.area_b
    per_a = model.beta * a_a / (model.dead_volume + a_a * place)
    per_b = model.beta * a_b / (model.dead_volume + a_b * (model.stroke - place))
    p_a, p_b = measured.pressure_a, measured.pressure_b
    k_oil = per_a * a_a + per_b * a_b
    wanted = (force_rate * (1.0 + k_oil / model.k_s)
              + block.velocity_share * k_oil * load_velocity
              + (per_a + per_b) * model.c_li * (p_a - p_b))
    least = block.least_drop
    if wanted > 0.0:
        gain = (per_a * model.f_pa * math.sqrt(max(least, block.p_s - p_a))
                + per_b * model.f_bt * math.sqrt(max(least, p_b - block.p_t)))
        return opening_of(wanted / (gain * model.per_root_drop), model)
    gain = (per_a * model.f_at * math.sqrt(max(least, p_a - block.p_t))
            + per_b * model.f_pb * math.sqrt(max(least, block.p_s - p_b)))
    return -opening_of(-wanted / (gain * model.per_root_drop), model)


@kernel
def linearising_step(reference, measured, velocity, block, state):
    """
    Run one period: F' = w (F_r - F - K_f dF/dt) + integral(K_i e)  (R8), then its opening  (R12).

    The speed of the load is the estimated one less the sensor's, F'/K_s, through the same
    low-pass. ``state`` is a `BLOCK_STATE`; anti-windup as in R5.
    """
    rate = (measured.force - state.measured) / block.period
    state.measured_rate = low_pass(state.measured_rate, rate, block.derivative_alpha)
    state.slow_rate = low_pass(state.slow_rate, rate, block.speed_alpha)
    state.measured = measured.force
    error = reference - measured.force
    force_rate = block.bandwidth * (error - block.kf * state.measured_rate) + state.integral
    load_velocity = velocity - state.slow_rate / block.model.k_s
    wanted = block.model.output_per_spool * opening_for(
        force_rate, measured, load_velocity, block)
    state.output = max(-block.limit, min(block.limit, wanted))
    if abs(wanted) < block.limit or error * wanted < 0.0 or block.is_clamped == 0.0:
        state.integral += block.ki * block.period * error
