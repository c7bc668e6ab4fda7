"""
Force or torque loop with velocity and dual-gain compensation.

Its output commands the next loop inwards: the spool position (m) of an electric-feedback
valve, or the series-scale coil current (A) of a mechanical-feedback valve. Gains are per
that unit: m/N or A/Nm.
"""

from dataclasses import dataclass

from isa_ros.kernel import kernel
from isa_ros.parameter import choice, parameter, Parameters
from isa_ros.reu.filters import low_pass, low_pass_coefficient
import numpy as np


@dataclass(frozen=True, kw_only=True)
class ForceLoop(Parameters):
    """Gains on the unit of the output: m (spool) or A (series current)."""

    rate_hz: float = parameter('loop rate', 'Hz', gt=0.0, le=50e3)
    kp: float = parameter('proportional gain K_p', 'm/N | A/Nm', ge=0.0, le=1.0)
    ki: float = parameter('integral gain K_i', 'm/(N s) | A/(Nm s)', ge=0.0, le=100.0)
    kf: float = parameter('force damping K_f', 's', ge=0.0, le=0.1)
    kv: float = parameter(
        'velocity compensation K_v', 'm per m/s | A per rad/s', ge=0.0, le=1.0)
    setpoint_weight: float = parameter('weight b of the reference', '1', ge=0.0, le=2.0)
    derivative_filter_hz: float = parameter('low-pass on dF/dt', 'Hz', gt=0.0, le=25e3)
    gain_schedule: str = choice(
        'gains over the stroke: constant, or divided by the oil stiffness relative to its least',
        'constant', 'oil_stiffness')


@dataclass(frozen=True, kw_only=True)
class DualGainCompensation(Parameters):
    """Inverse of the valve's dual-gain flow curve, and the saturation behind it."""

    knee: float = parameter('end of the low-gain region', 'm | A', gt=0.0, le=1.0)
    slope: float = parameter('low gain over high gain', '1', gt=0.0, le=1.0)
    limit: float = parameter('largest output', 'm | A', gt=0.0, le=1.0)


FORCE_LOOP = np.dtype([
    ('period', 'f8'), ('kp', 'f8'), ('ki', 'f8'), ('kf', 'f8'), ('kv', 'f8'), ('b', 'f8'),
    ('derivative_alpha', 'f8'),
    ('knee', 'f8'), ('slope', 'f8'), ('limit', 'f8')])
FORCE_STATE = np.dtype([
    ('integral', 'f8'), ('force', 'f8'), ('force_rate', 'f8'), ('output', 'f8')])


def force_loop_record(sheet: ForceLoop, dgc: DualGainCompensation) -> tuple[float, ...]:
    """Return the `FORCE_LOOP` record of the two sheets."""
    return (
        1.0 / sheet.rate_hz, sheet.kp, sheet.ki, sheet.kf, sheet.kv, sheet.setpoint_weight,
        low_pass_coefficient(sheet.derivative_filter_hz, sheet.rate_hz),
        dgc.knee, dgc.slope, dgc.limit)


@kernel
def dual_gain_compensation(demand, loop):
    """
    Return the continuous inverse of the flow curve  (R4), in the output's unit.

    |u| up to the knee passes, beyond it counts ``slope`` only, so that the flow is
    proportional to the demand. Our reading passes the whole demand (errata 23).
    """
    if demand > loop.knee:
        return loop.knee + loop.slope * (demand - loop.knee)
    if demand < -loop.knee:
        return -loop.knee + loop.slope * (demand + loop.knee)
    return demand


@kernel
def force_loop_step(reference, measured_force, velocity, gain, loop, state):
    """
    Run one period: u = K_p (b r - y - K_f dy/dt) + integral(K_i e) + K_v v  (R3).

    ``gain`` is the schedule's factor on K_p and K_i. The integral stands still while the
    realised output is saturated and the error would drive it further (R5).
    """
    rate = (measured_force - state.force) / loop.period
    state.force_rate = low_pass(state.force_rate, rate, loop.derivative_alpha)
    state.force = measured_force

    demand = (gain * loop.kp * (loop.b * reference - measured_force - loop.kf * state.force_rate)
              + state.integral + loop.kv * velocity)
    wanted = dual_gain_compensation(demand, loop)
    state.output = max(-loop.limit, min(loop.limit, wanted))

    error = reference - measured_force
    if state.output == wanted or error * wanted < 0.0:
        state.integral += gain * loop.ki * loop.period * error
