"""
What a drive supervises of itself beside its ratings: whether it follows, and moves as it should.

All from what the sensors read, the references of its blocks, and the supply pressure:

- whether each reading is within the range of its sensor (a live zero: a broken wire reads below),
  and not both pressures are at zero,
- how far position and force are from their references, where the valve could bring them there,
- whether the force oscillates by itself,
- whether the piston or rotor moves against the flow that its valve lets through.

Signs are those of the cascade.
"""

from isa_ros.core.device import FORCE, POSITION
from isa_ros.core.kernel import kernel
import numpy as np

END = 0.005     # of the stroke: nearer, or in a cushion, the end may take a force
MARGIN = 0.05   # of the range of the pressure sensors: a drop that drives a flow for certain
ZERO = 0.01     # of that range: the lands of a fed valve do not leave both chambers as empty
FED = 0.1       # of that range: a supply that feeds it
FILLING = 0.1   # s, until leakage at null has filled at least one of them from there

SUPERVISION = np.dtype([
    ('area_a', 'f8'), ('area_b', 'f8'),     # m2 | m3/rad
    ('flow_gain', 'f8'),                    # of a land at full opening, m3/s/sqrt(Pa)
    ('coulomb', 'f8'), ('viscous', 'f8'),   # of a motor's losses, Nm, Nms/rad; 0: a cylinder
    ('end_a', 'f8'), ('end_b', 'f8'),       # the cushions' lengths, m
    ('stroke', 'f8'), ('force_range', 'f8'), ('pressure_range', 'f8'), ('current_range', 'f8'),
    ('spool_range', 'f8'),                  # of its sensor, m; 0: there is none
    ('spool_gain', 'f8'),                   # m of spool per A of the amplifier
    ('opening', 'f8'),                      # of the spool, from which a flow is certain, m
    ('has_two', 'i8'),                      # 1: the valve feeds both chambers
    ('follows_force', 'i8'),                # 1: there is a force block
    ('creep', 'f8'),                        # slowest speed towards a reference, m/s | rad/s
    ('slow_share', 'f8'),                   # dt/(T + dt) of the low-pass that takes the slow part
    ('mean_share', 'f8'),                   # and of the mean of the rest
])
SUPERVISION_STATE = np.dtype([
    ('force', 'f8'), ('force_activity', 'f8'),      # slow part of it, N | Nm; mean of the rest
    ('target', 'f8'), ('target_activity', 'f8'),    # likewise, of the reference
    ('fed_for', 'f8'),                              # s that supply and lines have fed the valve
])


@kernel
def watch_feeding(supply_pressure, is_open, period, own, supervised):
    """Count for how long a supply has fed the chambers, through lines that are open."""
    if is_open == 1 and supply_pressure > FED * own.pressure_range:
        supervised.fed_for += period
    else:
        supervised.fed_for = 0.0


@kernel
def beyond_range(measured, supply_pressure, fed_for, own):
    """
    Return how far a converter's reading is beyond its range, as a part of the range.

    Of the supply's pressure, whose transmitter has a range of its own, only a broken wire is told.
    Both pressures at zero are such a reading, too, once they have been fed for `FILLING`: 1 at
    zero, 0 from `ZERO` on.
    """
    most = max(-supply_pressure, -measured.pressure_a, measured.pressure_a - own.pressure_range,
               -measured.pressure_b, measured.pressure_b - own.pressure_range)
    part = max(most / own.pressure_range, abs(measured.force) / own.force_range - 1.0,
               abs(measured.current) / own.current_range - 1.0)
    if own.spool_range > 0.0:
        part = max(part, abs(measured.spool) / own.spool_range - 1.0)
    if fed_for > FILLING and own.has_two == 1:
        higher = max(measured.pressure_a, measured.pressure_b)
        part = max(part, 1.0 - max(0.0, higher) / (ZERO * own.pressure_range))
    return max(0.0, part)


@kernel
def force_target(reference, velocity, supply_pressure, own):
    """
    Return the reference of the force block, as far as the valve can reach it  (R17), N or Nm.

    At full opening, with the drops (A v / K)^2 at both lands and none in the lines,
    F <= A_A P_S - (A_A^3 + A_B^3) v^2 / K^2 where it extends, likewise where it retracts. The
    friction of a motor, not as small as that of seals, takes its part as it drives and at rest.
    """
    a, b = own.area_a, own.area_b
    lost = (a * a * a + b * b * b) * (velocity / own.flow_gain) * (velocity / own.flow_gain)
    rubbed = own.coulomb + own.viscous * abs(velocity)
    highest = a * supply_pressure - (lost if velocity > 0.0 else 0.0)
    lowest = -b * supply_pressure + (lost if velocity < 0.0 else 0.0)
    if velocity >= 0.0:
        highest -= rubbed
    if velocity <= 0.0:
        lowest += rubbed
    return max(lowest, min(highest, reference))


@kernel
def position_error(reference, position, velocity, own):
    """Return the distance to the reference, m or rad; 0 while it moves there."""
    error = reference - position
    towards = velocity if error > 0.0 else -velocity
    return 0.0 if towards > own.creep else abs(error)


@kernel
def activity(value, own, slow, mean):
    """Return the slow part of a value, and the mean of what is left of it, after a conversion."""
    slow += own.slow_share * (value - slow)
    mean += own.mean_share * (abs(value - slow) - mean)
    return slow, mean


@kernel
def oscillation(force, target, own, state):
    """
    Return the mean fast part of a force beyond twice that of its reference  (R18), N or Nm.

    The fast part is what a low-pass of `slow_share` leaves. A force that follows a fast reference
    has about as much of it.
    """
    state.force, state.force_activity = activity(
        force, own, state.force, state.force_activity)
    state.target, state.target_activity = activity(
        target, own, state.target, state.target_activity)
    return max(0.0, state.force_activity - 2.0 * state.target_activity)


@kernel
def runaway(measured, velocity, supply_pressure, own):
    """
    Return the speed against the flow through the valve, m/s or rad/s; 0: it moves with it.

    A land that is open for certain lets oil in from a supply above the chamber's pressure, the
    other one lets it out: then the piston or rotor cannot move the other way for long.
    """
    spool = measured.spool if own.spool_range > 0.0 else own.spool_gain * measured.current
    if spool > own.opening:
        fills, empties, against = measured.pressure_a, measured.pressure_b, -velocity
    elif spool < -own.opening:
        fills, empties, against = measured.pressure_b, measured.pressure_a, velocity
    else:
        return 0.0
    margin = MARGIN * own.pressure_range
    if fills > supply_pressure - margin or empties < margin:
        return 0.0
    return max(0.0, against)


@kernel
def supervise(supply_pressure, own, state, supervised):
    """
    Return position error, force error, oscillation and runaway of a `REU_STATE`, SI.

    ``own`` is a `SUPERVISION`, ``supervised`` its state. A block that does not act has no error.
    """
    measured, velocity, status = state.measured, state.speed.velocity, state.status
    error, distance = 0.0, 0.0
    target = measured.force
    if status.is_on != 0 and status.acting >= FORCE and own.follows_force != 0:
        room = min(measured.position - own.end_a, own.stroke - own.end_b - measured.position)
        target = force_target(state.force_reference, velocity, supply_pressure, own)
        if room > END * own.stroke:     # else stop or cushion take a part that no sensor measures
            error = abs(measured.force - target)
    if status.is_stopping:
        if status.flow.is_held:
            distance = position_error(
                status.flow.place, measured.position, velocity, own)
    elif status.is_on != 0 and status.acting == POSITION:
        distance = position_error(
            state.setpoint.position, measured.position, velocity, own)
    swing = oscillation(measured.force, target, own, supervised)
    if status.is_on == 0:
        swing = 0.0
    return distance, error, swing, runaway(measured, velocity, supply_pressure, own)
