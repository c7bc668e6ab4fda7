"""
Ticks too long for the impacts of a body: reported before a run, which computes them roughly.

Body and actuators exchange forces once a tick. The first impact on a hard ground is right to half
a percent in any tick, but its rebound is not quite, and the next impact amplifies the error. The
bounds are from drops of the HyQ-REAL leg on grounds of 1e7 to 1e9 N/m^1.5 with ticks of 0.1 to
1 ms, docs/impacts.md.
"""

from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import MILLI
from isa_ros.surroundings.impact import contact_time

LEAST_TICKS = 3.0   # of an impact: with fewer, its peaks missed up to 7 %, with more 1.2 %
ENOUGH_TICKS = 5.0  # with so many they missed less than 1 %
_STEPS_MS = (0.5, 0.2, 0.1)     # of which a scenario's times are likely multiples


def coarse_ticks(
        called: str, mass: float, stiffness: float, step_ns: int) -> tuple[str, ...]:
    """
    Return a line if ticks are too long for the ground under a body, which messages call so.

    ``mass`` (kg) is that which the body puts behind a force of the ground, whose spring has a
    ``stiffness`` in N/m^1.5.
    """
    time, step = contact_time(mass, stiffness), step_ns / NS_PER_SECOND
    if time >= LEAST_TICKS * step:
        return ()
    fine = next((step_ms for step_ms in _STEPS_MS if time >= ENOUGH_TICKS * step_ms * MILLI),
                _STEPS_MS[-1])
    return (
        f'on the ground of {called}, stiffness = {stiffness:g} N/m^1.5, an impact '
        f'lasts {time / MILLI:.2g} ms, {time / step:.2g} ticks of step_ms = {step / MILLI:g}: its '
        f'peak forces may be several percent wrong; use step_ms: {fine:g} (docs/impacts.md)',)
