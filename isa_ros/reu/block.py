"""
One control block of the REU: PID with its feed-forward and feedback terms.

The same block controls position, force or torque, pressure difference or spool; its output
is the reference of the next block inwards, or the series-scale coil current (A) where there
is none. Gains are per that unit.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import choice, parameter, Parameters, tunable
from isa_ros.core.record import record
from isa_ros.reu.compensation import (
    compensated, COMPENSATION, compensation_record, DeadBand, demand_for, dual_gain_compensation,
    DualGain, Linear)
from isa_ros.reu.filters import low_pass, low_pass_coefficient
from isa_ros.reu.schedule import (
    Constant, FivePoints, OilStiffness, POINTS, scheduled, ThreePoints)
import numpy as np

LARGE = 0.1         # of the limit: a proportional part that only a turn of the reference makes
UNWINDING = 8.0     # a full integral is gone within 10 ms of a turn


@frozen(kw_only=True)
class Pid(Parameters):
    """PID gains, output per measured; the output's unit is that of the next block inwards."""

    rate_hz: float = parameter('loop rate', 'Hz', gt=0.0, le=50e3)
    kp: float = tunable('proportional gain K_p', 'output/measured', ge=0.0, le=1e9)
    ki: float = tunable('integral gain K_i', 'output/(measured s)', ge=0.0, le=1e9)
    kd: float = tunable('derivative gain K_d on the error', 'output s/measured', ge=0.0, le=1e6)
    kf: float = tunable('feedback damping K_f', 's', ge=0.0, le=0.1)
    kr: float = tunable('feed-forward of the reference', 'output/measured', ge=-1e9, le=1e9)
    kv: float = tunable(
        'velocity compensation K_v; negative: it brakes', 'output per m/s | output per rad/s',
        ge=-1e6, le=1e6)
    offset: float = tunable('added to the demand', 'output', ge=-1e9, le=1e9)
    feedback_damping: str = choice(
        "where K_f y' enters: in front of the whole PID, or in its proportional part only",
        'before_pid', 'proportional')
    setpoint_weight: float = tunable('weight b of the reference', '1', ge=0.0, le=2.0)
    measured_filter_hz: float = parameter(
        'low-pass on the measured value; 0: none', 'Hz', ge=0.0, le=25e3)
    derivative_filter_hz: float = parameter('low-pass on derivatives', 'Hz', ge=1e-3, le=25e3)
    limit: float = tunable('largest output', 'output', gt=0.0, le=1e9)
    anti_windup: str = choice(
        'clamped: the integral is held while the output is saturated; unwinding: and falls faster '
        'while a large error opposes it', 'clamped', 'none', 'unwinding')
    retracting_factor: float = tunable(
        'factor on demands that retract, for slots of equal area', '1', gt=0.0, le=10.0)
    gain_schedule: Constant | OilStiffness | ThreePoints | FivePoints
    compensation: Linear | DualGain | DeadBand


BLOCK = np.dtype([
    ('period', 'f8'), ('kp', 'f8'), ('ki', 'f8'), ('kd', 'f8'),
    ('kf', 'f8'), ('kf_of_error', 'f8'),    # K_f of the proportional part, and of I and D
    ('kr', 'f8'), ('kv', 'f8'), ('offset', 'f8'), ('b', 'f8'), ('measured_alpha', 'f8'),
    ('derivative_alpha', 'f8'), ('limit', 'f8'), ('is_clamped', 'f8'), ('unwinds', 'f8'),
    ('retracting', 'f8'),
    ('compensation', COMPENSATION), ('schedule', 'f8', (POINTS,))])
BLOCK_STATE = np.dtype([
    ('integral', 'f8'), ('measured', 'f8'), ('measured_rate', 'f8'), ('error', 'f8'),
    ('error_rate', 'f8'), ('slow_rate', 'f8'), ('output', 'f8')])


def block_record(sheet: Pid, table: np.ndarray) -> np.record:
    """Return the `BLOCK` record of a sheet; ``table`` (POINTS,) is its gain schedule."""
    smooths = sheet.measured_filter_hz > 0.0
    return record(
        BLOCK, period=1.0 / sheet.rate_hz, kp=sheet.kp, ki=sheet.ki, kd=sheet.kd, kf=sheet.kf,
        kf_of_error=sheet.kf if sheet.feedback_damping == 'before_pid' else 0.0,
        kr=sheet.kr, kv=sheet.kv, offset=sheet.offset, b=sheet.setpoint_weight,
        measured_alpha=(low_pass_coefficient(sheet.measured_filter_hz, sheet.rate_hz)
                        if smooths else 1.0),
        derivative_alpha=low_pass_coefficient(sheet.derivative_filter_hz, sheet.rate_hz),
        limit=sheet.limit, is_clamped=float(sheet.anti_windup != 'none'),
        unwinds=float(sheet.anti_windup == 'unwinding'), retracting=sheet.retracting_factor,
        compensation=compensation_record(sheet.compensation), schedule=table)


@kernel
def observe(reference, measured, block, state):
    """
    Filter the measured value, its derivative and that of the error  (R1, R13).

    The error that the integral and the derivative act on is e = r - y - K_f y' with the
    damping in front of the whole PID, r - y with that of the proportional part only.
    """
    value = low_pass(state.measured, measured, block.measured_alpha)
    rate = (value - state.measured) / block.period
    state.measured_rate = low_pass(state.measured_rate, rate, block.derivative_alpha)
    state.measured = value
    error = reference - value - block.kf_of_error * state.measured_rate
    rate = (error - state.error) / block.period
    state.error_rate = low_pass(state.error_rate, rate, block.derivative_alpha)
    state.error = error


@kernel
def uncompensated(reference, velocity, gain, block, state):
    """Return the demand of a block  (R3) before the factor on retracting, in the output's unit."""
    feedback = (gain * block.kp * (block.b * reference - state.measured
                                   - block.kf * state.measured_rate)
                + state.integral + block.kd * state.error_rate)
    ahead, of_speed = block.kr * reference + block.offset, block.kv * velocity
    if block.compensation.of_velocity:
        of_speed = dual_gain_compensation(of_speed, block.compensation)
    return feedback + of_speed + ahead


@kernel
def demanded(reference, velocity, gain, block, state):
    """
    Return the demand of a block  (R3), in the output's unit.

    u = w K_p (b r - y - K_f y') + I + K_d e' + K_r r + K_v v + u_0 with I' = w K_i e; ``gain``
    is the schedule's w. A retracting demand is scaled  (R7) before the flow curve is
    compensated  (R4, R21), so that the flow is scaled alike.
    """
    demand = uncompensated(reference, velocity, gain, block, state)
    if demand < 0.0:
        demand *= block.retracting
    if block.compensation.of_velocity:
        return demand
    return compensated(demand, block.compensation)


@kernel
def uncompensated_for(output, block):
    """Return the demand before factor and compensation that gives ``output``  (R4, R7, R21)."""
    demand = output
    if not block.compensation.of_velocity:
        demand = demand_for(output, block.compensation)
    return demand / block.retracting if demand < 0.0 else demand


@kernel
def unwound(change, gain, block, state):
    """
    Return the integral after a period that changes it by ``change``  (R22).

    A reference that turns round leaves an integral of the wrong sign: while the error opposes it,
    with a proportional part beyond `LARGE` of the limit, it falls `UNWINDING` times as fast, to 0.
    """
    if (state.error * state.integral >= 0.0
            or abs(gain * block.kp * state.error) <= LARGE * block.limit):
        return state.integral + change
    moved = state.integral + UNWINDING * change
    return moved if moved * state.integral > 0.0 else 0.0


@kernel
def block_step(reference, measured, velocity, place, stroke, block, state):
    """
    Run one period: measure, feed back, output, update.

    The schedule is read at ``place`` (m or rad). The integral is held while the realised
    output is saturated and the error would drive it further  (R5, R22).
    """
    observe(reference, measured, block, state)
    gain = scheduled(place, stroke, block.schedule)
    wanted = demanded(reference, velocity, gain, block, state)
    state.output = max(-block.limit, min(block.limit, wanted))
    if state.output == wanted or state.error * wanted < 0.0 or block.is_clamped == 0.0:
        change = gain * block.ki * block.period * state.error
        if block.unwinds > 0.0:
            state.integral = unwound(change, gain, block, state)
        else:
            state.integral += change


@kernel
def rest(state):
    """Reset integral and output of a block that is disabled."""
    state.integral = 0.0
    state.output = 0.0
