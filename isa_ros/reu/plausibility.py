"""
What the sensors of one actuator must have in common, and how far they do not.

Pressures times areas are the force sensor's reading, friction and the moving part's inertia; the
encoder moves no further between two conversions than the piston or rotor can; the spool follows
its reference as a sound valve moves it.
"""

from isa_ros.core.device import CURRENT
from isa_ros.core.kernel import kernel
import numpy as np

VALVE_EVIDENCE = np.dtype([
    ('is_watched', 'i8'),       # 1: there is a spool sensor, and a loop that the reference acts on
    ('is_piloted', 'i8'),       # 1: the spool block closes its loop, and has its reference
    ('gain', 'f8'),             # of that reference, 1; or m per A of the amplifier
    ('stop', 'f8'),             # of the spool, m
    ('play', 'f8'),             # half of its hysteresis, m
    ('share', 'f8'),            # of the way to the reference that a conversion takes, dt/(T + dt)
])
EVIDENCE = np.dtype([
    ('area_a', 'f8'), ('area_b', 'f8'),     # m2 | m3/rad
    ('force_range', 'f8'),                  # of the force sensor, N | Nm
    ('stiction', 'f8'), ('viscous', 'f8'),  # of the seals
    ('inertia', 'f8'),                      # of the moving part
    ('end_a', 'f8'), ('end_b', 'f8'),       # the cushions' lengths, m
    ('preload', 'f8'), ('stiffness', 'f8'),     # of a spring that pushes in, N, N/m
    ('speed_rate', 'f8'),                   # of the speed estimate, Hz
    ('speed_steps', 'i8'), ('offset_steps', 'i8'),
    ('valve', VALVE_EVIDENCE),
])
EVIDENCE_STATE = np.dtype([
    ('position', 'f8'),         # at the last conversion
    ('velocity', 'f8'),         # at the last period of the speed estimate
    ('acceleration', 'f8'),     # over that period
    ('spool', 'f8'),            # where the reference puts the spool, m
])


@kernel
def acceleration_step(step, velocity, evidence, state):
    """Difference the speed estimate, once in each of its periods."""
    if (step - evidence.offset_steps) % evidence.speed_steps == 0:
        state.acceleration = (velocity - state.velocity) * evidence.speed_rate
        state.velocity = velocity


@kernel
def unexplained_force(measured, velocity, stroke, evidence, state):
    """
    Return by how much pressures and force sensor contradict each other  (R14), N or Nm.

    max(0, |A_A p_A - A_B p_B - F_k - F| - (F_s + sigma_2 |v| + m |a|)) with the hydraulic force,
    less F_k of M5, clipped as the force sensor clips. At an end of the stroke, where a stop or
    cushion takes an unknown force, 0.
    """
    if measured.position <= evidence.end_a or measured.position >= stroke - evidence.end_b:
        return 0.0
    hydraulic = evidence.area_a * measured.pressure_a - evidence.area_b * measured.pressure_b
    hydraulic -= evidence.preload + evidence.stiffness * measured.position
    expected = max(-evidence.force_range, min(evidence.force_range, hydraulic))
    allowed = (evidence.stiction + evidence.viscous * abs(velocity)
               + evidence.inertia * abs(state.acceleration))
    return max(0.0, abs(expected - measured.force) - allowed)


@kernel
def jump_speed(position, period, state):
    """Return the speed that the encoder shows between two conversions, and store its reading."""
    speed = abs(position - state.position) / period
    state.position = position
    return speed


@kernel
def spool_deviation(state, evidence):
    """
    Return abs(x - x_e) - h, how far the spool is from where its reference puts it  (R15), in m.

    T x_e' = g r - x_e by the backward rule, g r clipped at the stops; a null bias is a deviation,
    but not half of the hysteresis, h; at least 0.
    ``state`` is a `REU_STATE`; its reference r is the amplifier's current, or that of the loop of
    a piloted spool. In the mode of the current that loop is open, and the spool anywhere: 0.
    """
    valve, own, spool = evidence.valve, state.protection.evidence, state.measured.spool
    if valve.is_watched == 0:
        return 0.0
    if valve.is_piloted == 0:
        reference = state.current_reference
    elif state.status.acting != CURRENT:
        reference = state.spool_reference
    else:
        own.spool = spool
        return 0.0
    target = max(-valve.stop, min(valve.stop, valve.gain * reference))
    own.spool += valve.share * (target - own.spool)
    return max(0.0, abs(spool - own.spool) - valve.play)
