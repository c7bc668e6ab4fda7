"""
Movements that the device commands itself: a stop, and the way back from a hold.

A stop acts in mode spool, whatever the mode and the wiring are: its law (`isa_ros.reu.flow_stop`)
gives the valve's reference. After a hold or a damp the setpoint in force may be far away; until it
is reached, the position block follows one that approaches it with a bounded speed.
"""

import math

from isa_ros.core.device import FORCE, PRESSURE
from isa_ros.core.kernel import kernel
from isa_ros.reu.bumpless import start_setpoint
from isa_ros.reu.flow_stop import (
    begin_flow_stop, flow_stop_step, stopping_speed, watch_rest)


@kernel
def bearing_reference(mode, state):
    """
    Return the reference of a mode that bears the load of a `REU_STATE`; 0: valve at null.

    Of the force without its swinging, which a device that does not move by itself follows.
    """
    if mode >= FORCE:
        return state.status.flow.slow_force
    if mode == PRESSURE:
        return state.measured.pressure_a - state.measured.pressure_b
    return 0.0


@kernel
def stay_here(mode, state):
    """Give a mode the setpoint at rest at the measured position, which bears the present load."""
    start_setpoint(mode, bearing_reference(mode, state), state)


@kernel
def begin_stop(rules, state):
    """Begin to stop at the measured position and the estimated speed."""
    own = state.status
    own.stop.position, own.stop.velocity = state.measured.position, state.speed.velocity
    own.stop.effort, own.stop.is_reference = 0.0, 1.0
    begin_flow_stop(
        own.stop.position, own.stop.velocity, state.measured.force, rules.flow, own.flow)
    command_stop(rules, state)


@kernel
def advance_stop(rules, state):
    """Advance the ramp of a stop by a period; after it, watch whether the load stands."""
    own = state.status
    before = own.stop.velocity
    if before == 0.0:
        watch_rest(state.measured.position, rules.flow, own.flow)
    own.stop.velocity = stopping_speed(before, state.speed.velocity, rules.flow, own.flow)
    own.stop.position += 0.5 * (before + own.stop.velocity) * rules.period
    command_stop(rules, state)


@kernel
def command_stop(rules, state):
    """Let the law of the stop command the valve."""
    own, measured = state.status, state.measured
    own.stop.reference = flow_stop_step(
        own.stop.velocity, measured.position, state.speed.velocity, measured.force,
        state.supply_pressure, rules.flow, own.flow)
    if own.flow.is_held:
        own.stop.position = own.flow.place


@kernel
def begin_return(effort, state):
    """Begin at rest at the measured position, with ``effort`` (N | Nm), to go to the setpoint."""
    back = state.status.back
    back.position, back.velocity, back.effort = state.measured.position, 0.0, effort
    state.status.return_speed = 0.0
    state.status.is_returning = 1


@kernel
def advance_return(rules, state):
    """
    Advance the way back by a period; end it where the setpoint is reached, or comes by.

    Position and effort go the same share of their ways, so that forces which cancel at both ends
    cancel in between. That share is such that neither shifts the rest of the impedance, which the
    effort does by itself over the stiffness, faster than the declared speed; it is gained and lost
    with the declared deceleration. The speed that the damping sees is that of the rest.

    A setpoint that moves faster than that comes by between two periods: the rest changes its sign.
    Its own step was larger than what is left then.
    """
    own, setpoint, period = state.status, state.setpoint, rules.period
    back, deceleration = own.back, rules.flow.deceleration
    back.stiffness, back.damping = setpoint.stiffness, setpoint.damping
    left, lacking = setpoint.position - back.position, setpoint.effort - back.effort
    way = rest = left
    if back.stiffness > 0.0:
        rest += lacking / back.stiffness
        way = max(abs(left), abs(lacking) / back.stiffness)
    way = abs(way)
    own.return_speed = min(own.return_speed + deceleration * period, rules.return_speed,
                           math.sqrt(2.0 * deceleration * way))
    change = max(own.return_speed, deceleration * period) * period
    if way <= change or back.velocity * rest < 0.0:
        own.is_returning = 0
    else:
        share = change / way
        back.velocity = share * rest / period
        back.position += share * left
        back.effort += share * lacking
