"""
Changes between modes and between gains without a jump of the valve current.

A block that begins to run gets the integral, and filters at rest at the measured value, with which
its output is the present reference of the block inside of it (back-calculation). What an integral
cannot take over, because its gain is zero or the block has a model instead, is added to the series
current and fades with a time constant. So the current is continuous whatever the gains are.
"""

from isa_ros.core.device import CURRENT, FORCE, IMPEDANCE, POSITION, PRESSURE, SPOOL
from isa_ros.core.kernel import kernel
from isa_ros.reu.block import rest, uncompensated, uncompensated_for
from isa_ros.reu.reactions import setpoint_in_force
from isa_ros.reu.schedule import scheduled
from isa_ros.reu.wiring import OFF, PID
import numpy as np

EVERY_BLOCK = 0b1111  # bits of the position, force, pressure and spool block

FADE = np.dtype([
    ('begins', 'i8'),    # bits of the blocks that have not run since a change: a jump may come
    ('is_on', 'i8'),     # 1: ``added`` is not zero
    ('added', 'f8')])    # series A
"""What is left of a jump."""

SMALLEST = 1e-9  # series A: a millionth of the rated current, far below the converters' step


@kernel
def faded(series, before, ran, share, fade):
    """
    Return the series current (A) without its jump; ``share`` of it is left after each period.

    ``before`` is the series current of the period before; ``ran`` are the bits of the blocks that
    ran in this one. The first time that each of them runs after a change it may jump.
    """
    if fade.begins & ran:
        fade.begins &= ~ran
        fade.is_on = 1
        fade.added = before - series
    else:
        fade.added *= share
        if abs(fade.added) < SMALLEST:
            fade.added = 0.0
            fade.is_on = 0
    return series + fade.added


@kernel
def back_calculate(output, measured, velocity, place, stroke, block, state):
    """
    Start a PID block at rest at its measured value, with the integral that gives ``output``.

    Without an integral gain the integral stays zero. ``output`` is also what the block gives
    until it is due.
    """
    rest(state)
    state.measured, state.measured_rate = measured, 0.0
    state.error = state.error_rate = 0.0
    state.output = output
    if block.ki > 0.0:
        gain = scheduled(place, stroke, block.schedule)
        state.integral = uncompensated_for(output, block) - uncompensated(
            measured, velocity, gain, block, state)


@kernel
def take_over(before, mode, reu, state):
    """
    Start the blocks that ``mode`` has and ``before`` has not; put those it has not to rest.

    Return the present reference of the outermost block of ``mode``: amplifier A, m of spool, Pa,
    N or Nm; of the position block the force or whatever it commands.
    """
    measured, velocity = state.measured, state.speed.velocity
    place = measured.position
    reference = state.current_reference / reu.parallel
    if mode >= SPOOL and reu.spool_kind != OFF:
        if before >= SPOOL:
            reference = state.spool_reference
        elif reu.spool_kind == PID:
            back_calculate(reference, measured.spool, velocity, place, reu.stroke, reu.spool,
                           state.spool)
            reference = measured.spool
        else:
            reference *= reu.k_spool
    if mode >= PRESSURE and reu.pressure_kind != OFF:
        difference = measured.pressure_a - measured.pressure_b
        if before >= PRESSURE:
            reference = pressure_reference(before, reu, state)
        else:
            back_calculate(reference, difference, velocity, place, reu.stroke, reu.pressure,
                           state.pressure)
            reference = difference
    elif mode < PRESSURE:
        rest(state.pressure)
    if mode >= FORCE and reu.force_kind != OFF:
        if before >= FORCE:
            reference = state.force_reference
        else:
            if reu.force_kind == PID:
                back_calculate(reference, measured.force, velocity, place, reu.stroke,
                               reu.force, state.force)
            else:
                rest(state.force)
                state.force.measured, state.force.output = measured.force, reference
                state.force.measured_rate = state.force.slow_rate = 0.0
            reference = measured.force
    elif mode < FORCE:
        rest(state.force)
        state.force_reference = 0.0
    if mode >= POSITION and before < POSITION:
        if reu.position_kind == PID:
            back_calculate(reference, place, 0.0, place, reu.stroke, reu.position, state.position)
        state.position.output = reference
    elif mode < POSITION:
        rest(state.position)
    if mode == CURRENT:
        return state.current_reference
    return reference


@kernel
def pressure_reference(mode, reu, state):
    """Return the reference of the pressure block in Pa, which the next block outwards gives."""
    if reu.pressure_kind == OFF or mode < PRESSURE:
        return 0.0
    if mode >= FORCE and reu.force_kind != OFF:
        return state.force.output
    if mode >= POSITION:
        return state.position.output
    return inner_reference(mode, setpoint_in_force(state), reu)


@kernel
def inner_reference(mode, setpoint, reu):
    """
    Return the setpoint of a mode without a position block, in the unit of its block.

    The effort, or the reference that was set after it; the current is on the series scale.
    """
    if setpoint.is_reference == 0.0:
        return setpoint.effort
    return setpoint.reference / reu.parallel if mode == CURRENT else setpoint.reference


@kernel
def start_setpoint(mode, reference, state):
    """Give a mode the setpoint at which its outermost block has the present reference."""
    setpoint = state.setpoint
    setpoint.position, setpoint.velocity = state.measured.position, 0.0
    setpoint.effort = setpoint.reference = setpoint.is_reference = 0.0
    if mode < FORCE:
        setpoint.reference, setpoint.is_reference = reference, 1.0
    elif mode == FORCE or mode == IMPEDANCE:
        setpoint.effort = reference
