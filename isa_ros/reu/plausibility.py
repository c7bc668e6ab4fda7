"""
What the sensors of one actuator must have in common, and how far they do not.

Pressures times areas are the force sensor's reading, friction and the moving part's inertia; the
encoder moves no further between two conversions than the piston or rotor can.
"""

from isa_ros.core.kernel import kernel
import numpy as np

EVIDENCE = np.dtype([
    ('area_a', 'f8'), ('area_b', 'f8'),     # m2 | m3/rad
    ('force_range', 'f8'),                  # of the force sensor, N | Nm
    ('stiction', 'f8'), ('viscous', 'f8'),  # of the seals
    ('inertia', 'f8'),                      # of the moving part
    ('speed_rate', 'f8'),                   # of the speed estimate, Hz
    ('speed_steps', 'i8'), ('offset_steps', 'i8'),
])
EVIDENCE_STATE = np.dtype([
    ('position', 'f8'),         # at the last conversion
    ('velocity', 'f8'),         # at the last period of the speed estimate
    ('acceleration', 'f8'),     # over that period
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

    max(0, |A_A p_A - A_B p_B - F| - (F_s + sigma_2 |v| + m |a|)) with the hydraulic force clipped
    as the force sensor clips. At an end of the stroke, where the stop takes an unknown force, 0.
    """
    if measured.position <= 0.0 or measured.position >= stroke:
        return 0.0
    hydraulic = evidence.area_a * measured.pressure_a - evidence.area_b * measured.pressure_b
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
