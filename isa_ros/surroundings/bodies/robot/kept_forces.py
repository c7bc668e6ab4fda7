"""
What a robot assumes of its actuators' forces during the next tick: a line through the last one's.

A light load cell rings between the actuator's moving part and its load, at rates near the tick's.
If the line had a part of that, the other actuators would get it as a trend, and the exchange
would feed it. So the line is that of the force which a rigid cell would transmit  (L32).
"""

from typing import Any, NamedTuple

from isa_ros.core.kernel import kernel, kernel_function
from isa_ros.core.timebase import FORCE_WINDOWS
from isa_ros.surroundings.port import window_line

FIELDS = 5


class KeptForces(NamedTuple):
    """Views of what `keep_rigid_forces` keeps, (k,) each."""

    force: Any
    """Assumed at the tick's end, N | Nm."""
    slope: Any
    """Its slope, N/s | Nm/s."""
    last_force: Any
    """In the load cell at the tick's end, N | Nm."""
    stretch: Any
    """Of the load cell then, m | rad."""
    stretch_rate: Any
    """Its rate, m/s | rad/s."""


@kernel_function
def kept_part(state, k):
    """Return the views of the forces in a state."""
    at = len(state) - FIELDS * k - 1
    return KeptForces(
        force=state[at:at + k], slope=state[at + k:at + 2 * k],
        last_force=state[at + 2 * k:at + 3 * k], stretch=state[at + 3 * k:at + 4 * k],
        stretch_rate=state[at + 4 * k:at + 5 * k])


@kernel
def rigid_line(tick, means, forces, stretches, rates, mass):
    """
    Return mean and slope over a tick of Q = F + mu e'', the force of a rigid load cell  (L32).

    ``means`` of F in the windows, ``forces`` F, ``stretches`` e and ``rates`` e' at the tick's
    ends, pairs. ``mass`` mu, with which moving part and load swing against each other:
    mu e'' + F is free of that swing, whatever the cell's stiffness, damping and play. The slope is
    that of the line of least squares, 12/H^3 of the first moment about the tick's middle, to which
    F adds h^2/12 of its growth within windows of h seconds.
    """
    mean, rise, _ = window_line(means)
    n = float(FORCE_WINDOWS)
    growth = (n * n - 1.0) / n * rise + (forces[1] - forces[0]) / (n * n)
    swing = 0.5 * tick * (rates[0] + rates[1]) - (stretches[1] - stretches[0])
    slope = (growth + 12.0 * mass * swing / (tick * tick)) / tick
    return mean + mass * (rates[1] - rates[0]) / tick, slope


@kernel
def keep_rigid_forces(kept, tick, rows, drives, replies):
    """
    Keep what each port will assume of the forces, F + F' t from the tick's end on  (L32).

    ``drives`` have the motion of the loads at the tick's end, and 1/m_eff of its ports.
    """
    for j in range(len(rows)):
        reply, drive = replies[rows[j]], drives[j]
        stretch = reply.position - drive.position
        rate = reply.velocity - drive.velocity
        mass = drive.moving_mass / (1.0 + drive.moving_mass * drive.inverse_mass)
        mean, slope = rigid_line(
            tick, reply.mean_forces, (kept.last_force[j], reply.force),
            (kept.stretch[j], stretch), (kept.stretch_rate[j], rate), mass)
        kept.force[j], kept.slope[j] = mean + 0.5 * tick * slope, slope
        kept.last_force[j], kept.stretch[j], kept.stretch_rate[j] = reply.force, stretch, rate
