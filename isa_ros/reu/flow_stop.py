"""
The flow stop: brings the piston or rotor to rest with the flow through the valve  (R16).

Oil that cannot leave a chamber bears any load, so a stop closes the valve along a ramp of the
speed. The orifice law at the measured force gives the opening for a speed; a share of the fast
part of the force is taken off the speed and damps the mass on its oil. The ramp ends gently, so
that the oil which brakes the mass expands while it still moves. At rest a slow position loop makes
up for leakage and a null bias, except on load-holding valves. The load appears in no gain: all of
them follow from the lag of the valve and the stiffness of the oil.

A heavy load still moves when the ramp has ended: a stop is over once the position stands.

Chamber A is the cap side; `s > 0` extends; a force > 0 pushes out. Lengths are m | rad, forces N |
Nm, the output m of spool or series A.
"""

import math

from isa_ros.core.kernel import kernel
from isa_ros.core.record import record
from isa_ros.reu.feedback_linearisation import LINEARISED, opening_of
from isa_ros.reu.filters import low_pass, low_pass_coefficient
from isa_ros.reu.schedule import POINTS, scheduled
import numpy as np

DAMPING = 0.15          # D: crossover of the force feedback when blocked, times the valve's lag
FORCE_FILTER = 200.0    # rad/s, of the force in the orifice law: below the valve's own damping
BASE_FILTER = 22.0      # rad/s; faster changes of the force are damped, slower ones are borne
LEAST_DROP = 0.5        # of the stall force is kept over the lands: opens by at most sqrt(2) more
HOLD_SHARE = 0.25       # crossover of the position loop over that of the force feedback
INTEGRAL_SHARE = 0.125  # K_i over K^2 of that loop
ROUNDING = 1.6          # end of the ramp over the damping's time constant: 200 kg then stay
TURNING = 0.1           # s after the ramp, at most, until a load that it left behind turns
SETTLING = 0.01         # s from then on before the position that was reached is taken,
AVERAGING = 0.02        # s, as a mean: it still swings on its oil
REST_SPAN = 1e-3        # of the stroke: the position stands that stays within it,
REST_TIME = 0.02        # s, for this time
LONGEST = 1.0           # s after the ramp: then a stop is over wherever the load moves
END_MARGIN = 0.02       # of the stroke, left in front of an end by a stop
SPEED_MARGIN = 2.0      # a T, by which the ramp may be above the estimated speed
LEAST_SUPPLY = 1e5      # Pa: below it the lands have no drop to meter with

FLOW_STOP = np.dtype([
    ('model', LINEARISED),
    ('extending', 'f8'), ('retracting', 'f8'),   # S, m6 | m9: pressure drop over both lands
    ('period', 'f8'), ('lag', 'f8'),             # of the conversions and of the valve T, s
    ('deceleration', 'f8'),                      # m/s2
    ('is_endless', 'f8'),                        # 1: there is no end of the stroke
    ('rounding', 'f8'),                          # m/s, below which it fades
    ('span', 'f8'),                              # within which a position stands, m
    ('turning', 'f8'), ('window', 'f8'), ('longest', 'f8'),     # conversions
    ('force_alpha', 'f8'), ('base_alpha', 'f8'), ('error_alpha', 'f8'),
    ('damping', 'f8'),                           # C where the oil is softest, m/s per N
    ('schedule', 'f8', (POINTS,)),               # C over that
    ('hold', 'f8'), ('integral', 'f8'),          # K in 1/s, K_i in 1/s2
    ('largest', 'f8')])                          # m/s, of the position loop
FLOW_STOP_STATE = np.dtype([
    ('deceleration', 'f8'),                      # of this stop, m/s2
    ('force', 'f8'), ('slow_force', 'f8'),       # low-passes of the force, N
    ('place', 'f8'), ('error', 'f8'),            # held position and its filtered error, m
    ('integral', 'f8'),                          # m/s
    ('rest', 'f8'),                              # s since the load has turned
    ('since_ramp', 'f8'), ('standing', 'f8'),    # conversions since its end, and of standing
    ('lowest', 'f8'), ('highest', 'f8'),         # position while it stands, m
    ('is_held', 'i8')])                          # 1: ``place`` is held


def flow_stop_record(
        model: np.record, stiffness: np.ndarray, lag: float, null_speed: float, period: float,
        deceleration: float, resolution: float) -> np.record:
    """
    Return the `FLOW_STOP` record of a `LINEARISED` model.

    ``stiffness`` (POINTS,) of the force loop in N/m, ``lag`` of the valve and ``period`` of the
    conversions in s, ``null_speed`` in m/s: with the slope about null over the whole travel;
    ``resolution`` of the encoder in m.
    """
    a, b = model.area_a, model.area_b
    least = float(np.min(stiffness))
    crossover = DAMPING / lag
    hold = HOLD_SHARE * crossover
    return record(
        FLOW_STOP, model=model,
        extending=a * a * a / (model.f_pa * model.f_pa) + b * b * b / (model.f_bt * model.f_bt),
        retracting=a * a * a / (model.f_at * model.f_at) + b * b * b / (model.f_pb * model.f_pb),
        period=period, lag=lag, deceleration=deceleration,
        is_endless=0.0,
        rounding=0.5 * ROUNDING * deceleration / crossover,
        span=max(REST_SPAN * model.stroke, 2.0 * resolution), turning=round(TURNING / period),
        window=round(REST_TIME / period), longest=round(LONGEST / period),
        force_alpha=_alpha(FORCE_FILTER, period), base_alpha=_alpha(BASE_FILTER, period),
        error_alpha=_alpha(crossover, period), damping=crossover / least,
        schedule=least / stiffness, hold=hold, integral=INTEGRAL_SHARE * hold * hold,
        largest=null_speed)


def end_on_holding_valves(flow_stop: np.ndarray) -> None:
    """
    Take the position loop out of the `FLOW_STOP` of an actuator with load-holding valves.

    They bear the load once the servo valve is at null, and that loop would open them in turn: a
    boom then swings by more with each turn.
    """
    flow_stop['hold'] = flow_stop['integral'] = 0.0


def _alpha(corner: float, period: float) -> float:
    """Return the coefficient of a low-pass with a corner in rad/s  (R1)."""
    return low_pass_coefficient(corner / (2.0 * math.pi), 1.0 / period)


@kernel
def stop_deceleration(position, velocity, setup):
    """Return the deceleration of a stop, m/s2: the declared one, or more before an end  (R16)."""
    if setup.is_endless > 0.0:
        return setup.deceleration
    stroke = setup.model.stroke
    room = stroke - position if velocity > 0.0 else position
    room -= END_MARGIN * stroke + abs(velocity) * setup.lag
    if room <= 0.0:
        return max(setup.deceleration, abs(velocity) / setup.period)
    return max(setup.deceleration, 0.5 * velocity * velocity / room)


@kernel
def begin_flow_stop(position, velocity, force, setup, state):
    """Begin at a measured position, estimated speed and measured force."""
    state.deceleration = stop_deceleration(position, velocity, setup)
    state.force = state.slow_force = force
    state.place = state.error = state.integral = state.rest = 0.0
    state.since_ramp = state.standing = 0.0
    state.lowest = state.highest = position
    state.is_held = 0


@kernel
def stopping_speed(reference, velocity, setup, state):
    """
    Return the speed of the ramp one period after ``reference``, m/s.

    Near rest its deceleration fades as the root of the speed, which is a constant jerk. It stays
    within 2 a T of the estimated ``velocity``: an estimate that was wrong at the beginning must
    not be driven.
    """
    share = math.sqrt(min(1.0, abs(reference) / setup.rounding))
    change = share * state.deceleration * setup.period
    most = SPEED_MARGIN * state.deceleration * setup.lag
    if reference > 0.0:
        return max(0.0, min(reference - change, max(0.0, velocity) + most))
    return min(0.0, max(reference + change, min(0.0, velocity) - most))


@kernel
def opening_for_speed(speed, force, supply_pressure, setup):
    """
    Return the output at which the piston has ``speed`` (m/s) under ``force`` (N)  (R16).

    The drops of both lands in series, from V7 at rest of pressure without leakage:
    `F_0 -+ F = v^2 S dp_ref / g^2`, where P_S is gauge and the return pressure neglected.
    """
    model = setup.model
    if speed == 0.0:
        return 0.0
    pressure = max(LEAST_SUPPLY, supply_pressure)
    if speed > 0.0:
        stall, lands, opposing = model.area_a * pressure, setup.extending, force
    else:
        stall, lands, opposing = model.area_b * pressure, setup.retracting, -force
    left = max(LEAST_DROP * stall, stall - opposing)
    flow = abs(speed) * math.sqrt(lands / left) / model.per_root_drop
    opening = model.output_per_spool * opening_of(flow, model)
    return opening if speed > 0.0 else -opening


@kernel
def watch_rest(position, setup, state):
    """Count the conversions after the ramp, and those for which the position has stood."""
    state.since_ramp += 1.0
    state.standing += 1.0
    state.lowest, state.highest = min(state.lowest, position), max(state.highest, position)
    if state.highest - state.lowest > setup.span:
        state.lowest = state.highest = position
        state.standing = 0.0


@kernel
def has_stood(conversions, setup, state):
    """Return whether the position has stood so long, or has had `LONGEST` more for it."""
    return (state.standing >= conversions
            or state.since_ramp >= setup.longest + conversions)


@kernel
def stands(setup, state):
    """Return whether the load of a stop is at rest, as far as it comes to rest."""
    return has_stood(setup.window, setup, state)


@kernel
def holding_speed(position, velocity, setup, state):
    """
    Return the speed with which the position loop holds what was reached, m/s  (R16).

    A load that the ramp has left behind is not held before it turns: its estimated ``velocity``
    is as small as what the ramp takes off within the valve's lag.
    """
    if (state.rest == 0.0 and state.since_ramp < setup.turning
            and abs(velocity) > setup.deceleration * setup.lag):
        return 0.0
    state.rest += setup.period
    if state.rest <= SETTLING + AVERAGING:
        if state.rest > SETTLING:
            share = setup.period / (state.rest - SETTLING)
            state.place += min(1.0, share) * (position - state.place)
        return 0.0
    state.is_held = 1
    state.error = low_pass(state.error, state.place - position, setup.error_alpha)
    state.integral += setup.integral * setup.period * state.error
    state.integral = max(-setup.largest, min(setup.largest, state.integral))
    speed = setup.hold * state.error + state.integral
    return max(-setup.largest, min(setup.largest, speed))


@kernel
def watch_load(force, setup, state):
    """Follow the load that a stop, or a closed valve, bears: the force without its swinging."""
    state.slow_force = low_pass(state.slow_force, force, setup.base_alpha)


@kernel
def flow_stop_step(reference, position, velocity, force, supply_pressure, setup, state):
    """Run one period of R16 at a ``reference`` speed (m/s); return the valve's output."""
    state.force = low_pass(state.force, force, setup.force_alpha)
    watch_load(force, setup, state)
    gain = setup.damping * scheduled(position, setup.model.stroke, setup.schedule)
    speed = reference - gain * (force - state.slow_force)
    if reference == 0.0:
        speed += holding_speed(position, velocity, setup, state)
    return opening_for_speed(speed, state.force, supply_pressure, setup)
