"""
The REU's protection: measures every condition and judges it; `isa_ros.reu.reactions` reacts.

A condition counts once its quantity has been beyond a level at as many conversions in a row as
its delay has; it ends when the quantity is back by the hysteresis, or is no longer watched. A trip
whose reaction stopped the actuator (quick_stop, disable, block) stays after its condition has
ended, until it is cleared, whatever its reaction has become. Levels, delays, reactions and the
mask may change at any tick; counts and bits go on from where they are.
Inputs are what the sensors read, not the exact states.
"""

from collections import namedtuple
import math
from typing import Any, NamedTuple

from isa_ros.core.conditions import BITS, CONDITIONS, REACTIONS
from isa_ros.core.device import POSITION
from isa_ros.core.kernel import kernel
from isa_ros.core.record import record
from isa_ros.core.timebase import PLANT_STEP
from isa_ros.core.units import MILLI
from isa_ros.reu.impedance import SETPOINT
from isa_ros.reu.plausibility import (
    EVIDENCE, EVIDENCE_STATE, jump_speed, spool_deviation, unexplained_force)
from isa_ros.reu.protection_sheet import levels_of, Protection
from isa_ros.reu.supervision import (
    beyond_range, supervise, SUPERVISION, SUPERVISION_STATE, watch_feeding)
import numpy as np

N = len(CONDITIONS)
NONE, WARN, LIMIT, HOLD, DAMP, QUICK_STOP, DISABLE, BLOCK = range(len(REACTIONS))
_Bits = namedtuple('_Bits', BITS)  # type: ignore[misc]
BIT: Any = _Bits(*BITS.values())  # for kernels, which read it by name: BIT.overload
EXTENDING, RETRACTING = 1, 2  # bits of the directions that are inhibited
TAKEN, GONE = 1, 2  # of the supply pressure: it may fall, it has fallen

PROTECTION = np.dtype([
    ('is_on', 'i8'),
    ('period', 'f8'),               # of the conversions, s
    ('stroke', 'f8'),
    ('warning', 'f8', (N,)),        # SI; levels of what is below them have their sign changed,
    ('trip', 'f8', (N,)),           # as the quantity has; infinite where off
    ('warning_end', 'f8', (N,)),    # where the condition ends
    ('trip_end', 'f8', (N,)),
    ('quiet', 'f8', (N,)),          # up to here nothing begins and nothing is left
    ('sign', 'f8', (N,)),
    ('delay', 'i8', (N,)),          # conversions
    ('reaction', 'i8', (N,)),
    ('evidence', EVIDENCE),
    ('supervision', SUPERVISION),
])
PROTECTION_STATE = np.dtype([
    ('warnings', 'i8'), ('trips', 'i8'),    # bit sets of conditions
    ('reaction', 'i8'),                     # the strongest of the trips
    ('first', 'i8'),                        # bit set: the first of the present trips
    ('last', 'i8'), ('last_warning', 'i8'),     # place + 1 of the last set of each; 0: none
    ('present', 'i8'),                      # bit set: trips whose condition has not ended
    ('kept', 'i8'),                         # bit set: trips that have stopped the actuator
    ('clears', 'i8'),                       # 1: trips whose condition has ended are to be cleared
    ('inhibited', 'i8'),                    # EXTENDING, RETRACTING
    ('supply_taken', 'i8'),                 # TAKEN, GONE: by an emergency stop; 0: by none
    ('busy', 'i8'),                         # bit set: is counted, or has a bit
    ('setpoint_age', 'i8'),                 # conversions + 1 since the last one; 0: none yet
    ('warning_count', 'i8', (N,)),          # conversions in a row beyond the level
    ('trip_count', 'i8', (N,)),
    ('warning_since', 'i8', (N,)),          # plant step at which the bit was set last
    ('trip_since', 'i8', (N,)),
    ('values', 'f8', (N,)),                 # quantities at the last conversion, SI
    ('trip_values', 'f8', (N,)),            # quantities when the trip was set, SI
    ('trip_level', 'f8'),                   # what the last trip was beyond, SI
    ('setpoint', SETPOINT),                 # in force instead of the commanded one
    ('evidence', EVIDENCE_STATE),
    ('supervision', SUPERVISION_STATE),
])


class Ratings(NamedTuple):
    """What the levels are parts of, SI; a field for each of `isa_ros.core.conditions.RATINGS`."""

    stroke: float
    speed: float
    """At full opening with the opening pressure of the relief valves over one land, or twice of it
    over that of a single-acting cylinder."""
    force_range: float
    pressure_range: float
    current_range: float
    opening_pressure: float
    spool_stop: float

    def of(self, name: str) -> float:
        """Return the rating of a condition, 1 for levels in the unit of its quantity."""
        rating = CONDITIONS[BITS[name]].rating
        return getattr(self, rating) if rating else 1.0


def protection_record(
        sheet: Protection, ratings: Ratings, evidence: np.record, supervision: np.record,
        conversion_steps: int, link_timeout: float = 0.0, watchdog: float = 0.0) -> np.record:
    """
    Return the `PROTECTION` record of a sheet; a conversion is every ``conversion_steps``.

    ``link_timeout`` is that of the link's watchdog in s, ``watchdog`` that of the REU's own; 0:
    none.
    """
    period = conversion_steps * PLANT_STEP
    levels = {name: np.full(N, math.inf) for name in (
        'warning', 'trip', 'warning_end', 'trip_end')}
    delay, reaction = np.zeros(N, np.int64), np.zeros(N, np.int64)
    mask = int(sheet.mask)
    sign = np.array([1.0 if condition.is_above else -1.0 for condition in CONDITIONS])

    def set_level(which: str, bit: int, level: float) -> None:
        if mask >> bit & 1:
            return
        back = level * (1.0 - sign[bit] * sheet.hysteresis)
        levels[which][bit], levels[f'{which}_end'][bit] = sign[bit] * level, sign[bit] * back

    for name, own in levels_of(sheet).items():
        bit, rating = BITS[name], ratings.of(name)
        reaction[bit] = REACTIONS.index(own.reaction)
        delay[bit] = math.ceil(round(own.delay_ms * MILLI / period, _DIGITS))
        for which, level in (('warning', own.warning), ('trip', own.trip)):
            if level and own.reaction != 'none' and rating < math.inf and (
                    bit != BIT.spool_deviation or evidence.valve.is_watched):
                set_level(which, bit, level * rating)
    if sheet.setpoint_timeout_ms:
        conversions = math.ceil(round(sheet.setpoint_timeout_ms * MILLI / period, _DIGITS))
        set_level('trip', BIT.setpoint_timeout, conversions * period)
        reaction[BIT.setpoint_timeout] = REACTIONS.index(sheet.setpoint_timeout_reaction)
    if link_timeout:
        set_level('trip', BIT.link_lost, link_timeout)
        reaction[BIT.link_lost] = REACTIONS.index(sheet.link_lost_reaction)
    if watchdog:
        set_level('trip', BIT.watchdog, watchdog)
        reaction[BIT.watchdog] = REACTIONS.index(sheet.watchdog_reaction)
    quiet = np.minimum(levels['warning'], levels['trip'])
    return record(
        PROTECTION, is_on=int(sheet.switch == 'on'), period=period,
        stroke=ratings.stroke, **levels, quiet=quiet, sign=sign,
        delay=delay, reaction=reaction, evidence=evidence, supervision=supervision)


_DIGITS = 9  # a delay of 10 ms is 100 periods of 0.1 ms, not 101


@kernel
def measure(supply_pressure, temperature, protection, state):
    """Write the quantity of every condition at one conversion, SI; ``state`` is a `REU_STATE`."""
    own, measured, velocity = state.protection, state.measured, state.speed.velocity
    values = own.values
    if own.setpoint_age > 0:
        if not state.status.is_on:
            own.setpoint_age = 1
        values[BIT.setpoint_timeout] = (own.setpoint_age - 1) * protection.period
        own.setpoint_age += 1
    values[BIT.end_of_stroke] = min(measured.position, protection.stroke - measured.position)
    values[BIT.overspeed] = abs(velocity)
    values[BIT.overload] = abs(measured.force)
    values[BIT.overpressure] = max(measured.pressure_a, measured.pressure_b)
    values[BIT.overcurrent] = abs(measured.current)
    values[BIT.overtemperature] = temperature
    values[BIT.supply_low] = supply_pressure
    if own.supply_taken != 0:
        await_supply(supply_pressure, protection, state)
    values[BIT.relief_open] = max(measured.pressure_a, measured.pressure_b)
    values[BIT.load_cell_implausible] = unexplained_force(
        measured, velocity, protection.stroke, protection.evidence, own.evidence)
    if state.frozen_for > 0.0:  # it moved while no program read it
        own.evidence.position = measured.position
    values[BIT.encoder_jump] = jump_speed(measured.position, protection.period, own.evidence)
    values[BIT.link_lost] = state.link_silence
    values[BIT.spool_deviation] = spool_deviation(state, protection.evidence)
    values[BIT.watchdog] = state.frozen_for
    state.frozen_for = 0.0
    own_supervision = protection.supervision
    watch_feeding(supply_pressure, state.status.is_open, protection.period, own_supervision,
                  own.supervision)
    values[BIT.sensor_range] = beyond_range(
        measured, supply_pressure, own.supervision.fed_for, own_supervision)
    (values[BIT.position_error], values[BIT.force_error], values[BIT.oscillation],
     values[BIT.runaway]) = supervise(
        supply_pressure, own_supervision, state, own.supervision)


@kernel
def await_supply(supply_pressure, protection, state):
    """
    Follow the supply pressure, Pa, that an emergency stop has taken.

    Until it has fallen and is back, or the outputs are on, `supply_low` does not trip: the group's
    members could neither be cleared nor released otherwise. After a release it may fall on.
    """
    own, excess = state.protection, -supply_pressure
    if excess > protection.trip[BIT.supply_low]:
        own.supply_taken = GONE
    elif own.supply_taken == GONE and excess <= protection.trip_end[BIT.supply_low]:
        own.supply_taken = 0
    if state.status.is_on == 1:
        own.supply_taken = 0


@kernel
def is_met(excess, level, end, was_met, count, delay):
    """
    Return whether a condition counts at this conversion.

    ``count`` are the conversions in a row, this one included, at which ``excess`` was beyond
    ``level``; a condition that counted goes on until ``excess`` is not beyond ``end``.
    """
    if was_met:
        return excess > end
    return excess > level and count > delay


@kernel
def reaction_of(k, mode, protection):
    """
    Return the reaction to a trip of condition ``k`` in a mode.

    Without a position block there is nothing that damps: then it is a quick stop.
    """
    reaction = protection.reaction[k]
    if reaction == DAMP and mode < POSITION:
        return QUICK_STOP
    return reaction


@kernel
def judge_one(k, step, mode, protection, own):
    """Update count and bits of condition ``k`` at plant step ``step`` in a mode."""
    bit, excess = 1 << k, protection.sign[k] * own.values[k]
    own.warning_count[k] = own.warning_count[k] + 1 if excess > protection.warning[k] else 0
    own.trip_count[k] = own.trip_count[k] + 1 if excess > protection.trip[k] else 0
    was_warned, was_met, was_tripped = (
        own.warnings & bit != 0, own.present & bit != 0, own.trips & bit != 0)
    warns = is_met(excess, protection.warning[k], protection.warning_end[k], was_warned,
                   own.warning_count[k], protection.delay[k])
    rests = k == BIT.supply_low and own.supply_taken != 0
    met = not rests and is_met(
        excess, protection.trip[k], protection.trip_end[k], was_met, own.trip_count[k],
        protection.delay[k])
    if met and reaction_of(k, mode, protection) >= QUICK_STOP:
        own.kept |= bit
    elif own.clears != 0:       # over, or its reaction has become weaker
        own.kept &= ~bit
    trips = met or own.kept & bit != 0
    if warns and not was_warned:
        own.warning_since[k], own.last_warning = step, k + 1
    if trips and not was_tripped:
        note_trip(k, step, protection.sign[k] * protection.trip[k], own)
    own.warnings = own.warnings | bit if warns else own.warnings & ~bit
    own.present = own.present | bit if met else own.present & ~bit
    own.trips = own.trips | bit if trips else own.trips & ~bit
    is_busy = warns or trips or own.warning_count[k] > 0 or own.trip_count[k] > 0
    own.busy = own.busy | bit if is_busy else own.busy & ~bit


@kernel
def note_trip(k, step, level, own):
    """Keep when condition ``k`` tripped, its quantity then, and its ``level``, SI."""
    own.trip_since[k], own.trip_values[k] = step, own.values[k]
    own.last, own.trip_level = k + 1, level


@kernel
def write_trips(own, sample):
    """Write warnings and trips, and when and why the last of each was set, into a `SAMPLE`."""
    sample.warnings, sample.trips = float(own.warnings), float(own.trips)
    sample.first_trip = float(own.first)
    if own.last:
        k = own.last - 1
        sample.last_trip, sample.trip_time = float(1 << k), own.trip_since[k] * PLANT_STEP
        sample.trip_value, sample.trip_level = own.trip_values[k], own.trip_level
    if own.last_warning:
        sample.warning_time = own.warning_since[own.last_warning - 1] * PLANT_STEP


@kernel
def judge(step, mode, protection, own):
    """Update the bits of all conditions from ``own.values``, in a mode."""
    for k in range(N):
        if protection.sign[k] * own.values[k] > protection.quiet[k] or own.busy >> k & 1:
            judge_one(k, step, mode, protection, own)
    own.clears = 0
    if own.trips & own.first == 0:  # cleared; of several trips that are left, the lowest bit
        own.first = own.trips & -own.trips


@kernel
def feed(own):
    """Note that a setpoint has been received: its time begins anew."""
    own.setpoint_age = 1


@kernel
def request_clear(own):
    """Let the next conversion clear the trips whose condition has ended."""
    own.clears = 1
