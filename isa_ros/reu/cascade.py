"""
The nested loops of figure 7 A and B at their rates.

One period of a loop is always: measure, feed back, output, update. Loops that coincide run
outermost first in the same instant; the current reference they give reaches the amplifier
after the computational delay, none by default. The inner loops whose closed form is the
plant's own (spool: equation 8, current: equation 10) sample and hold their reference here.

    position 1 kHz -> force 5 kHz -> [spool 5 kHz ->] current 10 kHz
"""

from dataclasses import dataclass

from isa_ros.errors import ConfigError
from isa_ros.kernel import kernel
from isa_ros.parameter import parameter, Parameters
from isa_ros.reu.force_loop import (
    DualGainCompensation, FORCE_LOOP, force_loop_record,
    force_loop_step, FORCE_STATE, ForceLoop)
from isa_ros.reu.position_loop import (
    POSITION_LOOP, position_loop_record, position_loop_step, POSITION_STATE, PositionLoop,
    SETPOINT)
from isa_ros.reu.schedule import POINTS, scheduled
from isa_ros.timebase import NS_PER_SECOND, PLANT_STEP_NS, steps_in
import numpy as np


@dataclass(frozen=True, kw_only=True)
class InnerLoop(Parameters):
    """A loop that samples and holds the reference of a closed inner loop."""

    rate_hz: float = parameter('loop rate', 'Hz', gt=0.0, le=50e3)


@dataclass(frozen=True, kw_only=True)
class Reu(Parameters):
    """The cascade's loops, outermost first."""

    position: PositionLoop
    force: ForceLoop
    compensation: DualGainCompensation
    spool: InnerLoop
    current: InnerLoop
    computation_delay_us: float = parameter(
        'from an instant of the loops to the current reference it gives', 'us', ge=0.0, le=1e3)


REU = np.dtype([
    ('position', POSITION_LOOP),
    ('force', FORCE_LOOP),
    ('position_steps', 'i8'), ('force_steps', 'i8'), ('spool_steps', 'i8'),
    ('current_steps', 'i8'), ('offset_steps', 'i8'), ('delay_steps', 'i8'),
    ('stroke', 'f8'), ('schedule', 'f8', (POINTS,)),
    ('spool_per_output', 'f8'),    # m per unit of the force loop's output
    ('current_per_spool', 'f8'),   # amplifier A per m of spool
])
MEASURED = np.dtype([
    ('position', 'f8'), ('force', 'f8'), ('pressure_a', 'f8'), ('pressure_b', 'f8'),
    ('spool', 'f8'), ('current', 'f8')])
"""What the sensors gave last: encoder m | rad, N | Nm, Pa gauge, m, amplifier A."""

REU_STATE = np.dtype([
    ('measured', MEASURED),
    ('setpoint', SETPOINT),
    ('position', POSITION_STATE),
    ('force', FORCE_STATE),
    ('spool_reference', 'f8'),
    ('current_reference', 'f8'),
    ('current_output', 'f8'),      # the current reference the amplifier has
])


def loop_steps(reu: Reu) -> tuple[int, int, int, int]:
    """
    Return the periods of position, force, spool and current loop in plant steps.

    Raises
    ------
    ConfigError
        A rate is not a whole number of plant steps, or an outer period not a
        whole number of the next inner one; both are named.

    """
    names = ('position', 'force', 'spool', 'current')
    rates = [getattr(reu, name).rate_hz for name in names]
    steps = []
    for name, rate in zip(names, rates):
        period_ns = NS_PER_SECOND / rate
        if period_ns != int(period_ns):
            raise ConfigError(
                f'{name}.rate_hz = {rate:g} Hz, its period must be whole nanoseconds')
        steps.append(steps_in(int(period_ns), f'period of {name}.rate_hz = {rate:g} Hz'))
    for k in range(3):
        if steps[k] % steps[k + 1]:
            raise ConfigError(
                f'{names[k]}.rate_hz = {rates[k]:g} Hz does not divide '
                f'{names[k + 1]}.rate_hz = {rates[k + 1]:g} Hz')
    return steps[0], steps[1], steps[2], steps[3]


def delay_steps(reu: Reu, current_steps: int) -> int:
    """
    Return the computational delay in plant steps.

    Raises
    ------
    ConfigError
        It is not a whole number of plant steps, or as long as the current loop's period.

    """
    steps = reu.computation_delay_us * 1e3 / PLANT_STEP_NS
    if steps != int(steps) or steps >= current_steps:
        raise ConfigError(
            f'computation_delay_us = {reu.computation_delay_us:g} us, must be a multiple of '
            f'{PLANT_STEP_NS / 1e3:g} us below {current_steps * PLANT_STEP_NS / 1e3:g} us, '
            'the period of the current loop')
    return int(steps)


def reu_record(
        reu: Reu, offset_steps: int, stroke: float, schedule: np.ndarray,
        spool_per_output: float, current_per_spool: float) -> np.ndarray:
    """Return the `REU` record, shape (1,); ``schedule`` has shape (POINTS,)."""
    steps = loop_steps(reu)
    return np.array([(
        position_loop_record(reu.position), force_loop_record(reu.force, reu.compensation),
        *steps, offset_steps, delay_steps(reu, steps[-1]), stroke, schedule,
        spool_per_output, current_per_spool)], dtype=REU)


@kernel
def is_due(step, period_steps, offset_steps):
    """Return whether a loop samples at plant step ``step``."""
    return (step - offset_steps) % period_steps == 0


@kernel
def cascade_step(step, reu, state):
    """Run every loop that is due at plant step ``step`` on ``state.measured``."""
    if is_due(step, reu.position_steps, reu.offset_steps):
        position_loop_step(state.measured.position, state.setpoint, reu.position, state.position)
    if is_due(step, reu.force_steps, reu.offset_steps):
        gain = scheduled(state.measured.position, reu.stroke, reu.schedule)
        force_loop_step(state.position.force_reference, state.measured.force,
                        state.position.velocity, gain, reu.force, state.force)
    if state.setpoint.is_enabled == 0.0:
        state.force.integral = 0.0
        state.force.output = 0.0
    if is_due(step, reu.spool_steps, reu.offset_steps):
        state.spool_reference = reu.spool_per_output * state.force.output
    state.current_reference = reu.current_per_spool * state.spool_reference
