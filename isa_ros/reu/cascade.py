"""
The control blocks at their rates, outermost first: figure 7 A and B, and any other wiring.

One period of a block is always: measure, feed back, output, update. Blocks that coincide run
outermost first in the same instant; their output reaches the amplifier after the
computational delay, zero by default. A held block's loop is closed in the plant (spool:
equation 8, current: equation 10): it only samples and holds its reference.

    position 1 kHz -> force 5 kHz -> [spool 5 kHz ->] current 10 kHz
"""

from typing import NamedTuple

from isa_ros.core.device import CURRENT, FORCE, POSITION, PRESSURE
from isa_ros.core.kernel import kernel
from isa_ros.core.signals import MEASURED
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.core.units import MILLI, PERCENT
from isa_ros.reu.block import BLOCK, block_record, BLOCK_STATE, block_step, Pid, rest
from isa_ros.reu.block_drive import BlockWiring
from isa_ros.reu.bumpless import faded, inner_reference
from isa_ros.reu.device import device_step
from isa_ros.reu.device_record import DEVICE, device_record, DEVICE_STATE
from isa_ros.reu.dither import dither
from isa_ros.reu.feedback_linearisation import (
    FeedbackLinearisation, LINEARISATION, linearisation_record, linearising_step)
from isa_ros.reu.filters import SPEED, speed_record, SPEED_STATE, speed_step
from isa_ros.reu.flow_stop import flow_stop_record
from isa_ros.reu.impedance import force_reference, IMPEDANCE, Impedance, impedance_record, SETPOINT
from isa_ros.reu.lead_lag import LEAD_LAG, lead_lag_record, LEAD_LAG_STATE, lead_lag_step, LeadLag
from isa_ros.reu.protection import PROTECTION, PROTECTION_STATE
from isa_ros.reu.reactions import is_inhibited, setpoint_in_force
from isa_ros.reu.schedule import schedule_table
from isa_ros.reu.wiring import (
    delay_steps, IMPEDES, KINDS, LEADS_AND_LAGS, LINEARISES, loop_steps, OFF, PID, Reu)
import numpy as np

REU = np.dtype([
    ('speed', SPEED), ('impedance', IMPEDANCE), ('position', BLOCK), ('force', BLOCK),
    ('linearisation', LINEARISATION), ('pressure', BLOCK), ('spool', BLOCK),
    ('lead_lag', LEAD_LAG),
    ('position_kind', 'i8'), ('force_kind', 'i8'), ('pressure_kind', 'i8'),
    ('spool_kind', 'i8'), ('current_kind', 'i8'),
    ('speed_steps', 'i8'), ('position_steps', 'i8'), ('force_steps', 'i8'),
    ('pressure_steps', 'i8'), ('spool_steps', 'i8'), ('current_steps', 'i8'),
    ('offset_steps', 'i8'), ('delay_steps', 'i8'),
    ('stroke', 'f8'),
    ('k_spool', 'f8'),    # m of spool per series-scale A
    ('parallel', 'f8'),   # amplifier A per series-scale A
    ('dither', 'f8'),     # on the amplifier's current, A; 0: none
    ('dither_steps', 'i8'),     # half of its period
    ('is_frozen', 'f8'),
    ('watchdog', 'f8'),   # s; 0: none
    ('protection', PROTECTION),
    ('rules', DEVICE),
])
REU_STATE = np.dtype([
    ('measured', MEASURED),
    ('setpoint', SETPOINT),
    ('speed', SPEED_STATE),
    ('position', BLOCK_STATE),
    ('force', BLOCK_STATE),
    ('pressure', BLOCK_STATE),
    ('spool', BLOCK_STATE),
    ('lead_lag', LEAD_LAG_STATE),
    ('force_reference', 'f8'),     # N | Nm; 0 without a force block
    ('spool_reference', 'f8'),     # m
    ('current_reference', 'f8'),   # amplifier A
    ('drive', 'f8'),               # output of the blocks: A, or V
    ('amplifier', 'f8'),           # the drive after the computational delay
    ('protection', PROTECTION_STATE),
    ('status', DEVICE_STATE),
    ('supply_pressure', 'f8'),     # of the port at the last conversion, Pa
    ('frozen_for', 'f8'),          # s without the program
    ('link_silence', 'f8'),        # s since the last frame of a link with a watchdog
    ('link_lost', 'i8'),           # 1: no frame has come for the link's watchdog time
    ('link_lost_step', 'i8'),      # plant step at which it was last lost
])


class KnownPlant(NamedTuple):
    """What the REU knows of its actuator, SI."""

    stroke: float
    stiffness: np.ndarray
    """In the force loop, over the stroke, (POINTS,)."""
    model: np.record
    """`LINEARISED`, of a linearising block and of stops."""
    lag: float
    """Of the valve."""
    null_speed: float
    """With the valve's slope about null over its whole travel."""
    resolution: float
    """Of the encoder."""
    k_spool: float
    """Of spool per series-scale current."""
    parallel: float
    """Amplifier current per series-scale current."""
    block: BlockWiring


def reu_record(reu: Reu, offset_steps: int, plant: KnownPlant) -> np.ndarray:
    """Return the `REU` record, shape (1,)."""
    record = np.zeros(1, REU)
    row = record[0]
    steps = loop_steps(reu)
    row['speed'] = speed_record(reu.speed)
    for name in ('position', 'force', 'pressure', 'spool', 'current'):
        sheet = getattr(reu, name)
        row[f'{name}_kind'] = KINDS[type(sheet)]
        if isinstance(sheet, Pid):
            row[name] = block_record(sheet, schedule_table(sheet.gain_schedule, plant.stiffness))
    if isinstance(reu.position, Impedance):
        row['impedance'] = impedance_record(reu.position)
    if isinstance(reu.force, FeedbackLinearisation):
        row['linearisation'] = linearisation_record(
            reu.force, reu.speed.filter_hz, plant.model)
    if isinstance(reu.current, LeadLag):
        row['lead_lag'] = lead_lag_record(reu.current)
    for name, period in steps.items():
        row[f'{name}_steps'] = period
    row['offset_steps'], row['delay_steps'] = offset_steps, delay_steps(reu, steps['current'])
    row['stroke'], row['k_spool'], row['parallel'] = plant.stroke, plant.k_spool, plant.parallel
    conversion = steps['current'] * PLANT_STEP
    row['rules'] = device_record(reu.device, reu, conversion, flow_stop_record(
        plant.model, plant.stiffness, plant.lag, plant.null_speed, conversion,
        reu.device.quick_stop_deceleration, plant.resolution), plant.block)
    row['dither'] = (PERCENT * reu.current.dither_percent * plant.model.x_max / plant.k_spool
                     * plant.parallel)
    row['dither_steps'] = reu.current.half_period * steps['current']
    row['is_frozen'], row['watchdog'] = reu.frozen, reu.watchdog_ms * MILLI
    return record


def initial_gains(reu: Reu) -> tuple[float, float]:
    """Return the impedance's (stiffness, damping) before the first setpoint, else zeros."""
    if isinstance(reu.position, Impedance):
        return reu.position.stiffness, reu.position.damping
    return 0.0, 0.0


@kernel
def is_due(step, period_steps, offset_steps):
    """Return whether a block samples at plant step ``step``."""
    return (step - offset_steps) % period_steps == 0


@kernel
def ran(step, reu, acting):
    """Return the bits of `EVERY_BLOCK` that run at plant step ``step``, or not at all."""
    found = 0
    if acting < POSITION or is_due(step, reu.position_steps, reu.offset_steps):
        found |= 0b0001
    if acting < FORCE or reu.force_kind == OFF or is_due(
            step, reu.force_steps, reu.offset_steps):
        found |= 0b0010
    if acting < PRESSURE or reu.pressure_kind == OFF or is_due(
            step, reu.pressure_steps, reu.offset_steps):
        found |= 0b0100
    if acting == CURRENT or reu.spool_kind == OFF or is_due(
            step, reu.spool_steps, reu.offset_steps):
        found |= 0b1000
    return found


@kernel
def position_reference_inwards(step, reu, state):
    """Run the position block if it acts and is due; return the next block's reference."""
    device, setpoint = state.status, setpoint_in_force(state)
    if device.acting < POSITION:
        return inner_reference(device.acting, setpoint, reu)
    if is_due(step, reu.position_steps, reu.offset_steps):
        measured, velocity = state.measured.position, state.speed.velocity
        if reu.position_kind == IMPEDES:
            state.position.output = force_reference(
                setpoint, measured, velocity, reu.impedance)
        else:
            block_step(setpoint.position, measured, setpoint.velocity, measured,
                       reu.stroke, reu.position, state.position)
    return state.position.output


@kernel
def force_reference_inwards(step, reference, reu, state):
    """Run the force and pressure blocks that act and are due; return the next one's reference."""
    place, velocity, acting = state.measured.position, state.speed.velocity, state.status.acting
    if reu.force_kind != OFF and acting >= FORCE:
        state.force_reference = reference
        if is_due(step, reu.force_steps, reu.offset_steps):
            if reu.force_kind == LINEARISES:
                linearising_step(reference, state.measured, velocity, reu.linearisation,
                                 state.force)
            else:
                block_step(reference, state.measured.force, velocity, place, reu.stroke,
                           reu.force, state.force)
        reference = state.force.output
    if reu.pressure_kind != OFF and acting >= PRESSURE:
        if is_due(step, reu.pressure_steps, reu.offset_steps):
            block_step(reference, state.measured.pressure_a - state.measured.pressure_b,
                       velocity, place, reu.stroke, reu.pressure, state.pressure)
        reference = state.pressure.output
    return reference


@kernel
def spool_block(step, reference, reu, state):
    """
    Run the spool block if it acts and is due; return the series-scale current, in A.

    ``reference`` is the spool's in m, or that current without the block.
    """
    if reu.spool_kind == OFF or state.status.acting == CURRENT:
        state.spool_reference = reu.k_spool * reference
        return reference
    if is_due(step, reu.spool_steps, reu.offset_steps):
        state.spool_reference = reference
        if reu.spool_kind == PID:
            block_step(reference, state.measured.spool, state.speed.velocity,
                       state.measured.position, reu.stroke, reu.spool, state.spool)
    if reu.spool_kind == PID:
        return state.spool.output
    return state.spool_reference / reu.k_spool


@kernel
def cascade_step(step, reu, state):
    """Run the device and every block that is due at plant step ``step`` on ``state.measured``."""
    device = state.status
    device_step(step, reu, state)
    if is_due(step, reu.speed_steps, reu.offset_steps):
        speed_step(state.measured.position, reu.speed, state.speed)
    reference = position_reference_inwards(step, reu, state)
    reference = force_reference_inwards(step, reference, reu, state)
    if not device.is_on or is_inhibited(reference, state.protection):
        rest(state.position)
        rest(state.force)
        rest(state.pressure)
        reference = 0.0
    series = spool_block(step, reference, reu, state)
    if device.fade.begins or device.fade.is_on:
        series = faded(
            series, state.current_reference / reu.parallel, ran(step, reu, device.acting),
            reu.rules.fade, device.fade)
    state.current_reference = reu.parallel * series
    current = state.current_reference
    if reu.dither > 0.0 and device.is_on:
        current += dither(step, reu.offset_steps, reu.dither_steps, reu.dither)
    if reu.current_kind == LEADS_AND_LAGS:
        state.drive = lead_lag_step(
            current, state.measured.current, reu.lead_lag, state.lead_lag)
    else:
        state.drive = current
