"""
Ticks too long for the impacts of a leg: reported before a run, which computes them roughly.

Leg and actuators exchange forces once a tick. The first impact on a hard ground is right to half
a percent in any tick, but its rebound is not quite, and the next impact amplifies the error. The
bounds are from drops of the HyQ-REAL leg on grounds of 1e7 to 1e9 N/m^1.5 with ticks of 0.1 to
1 ms, docs/impacts.md.
"""

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import MILLI
from isa_ros.surroundings.bodies.leg.impact import contact_time

LEAST_TICKS = 3.0   # of an impact: with fewer, its peaks missed up to 7 %, with more 1.2 %
ENOUGH_TICKS = 5.0  # with so many they missed less than 1 %
_STEPS_MS = (0.5, 0.2, 0.1)     # of which a scenario's times are likely multiples


def coarse_ticks(run: RunConfig) -> tuple[str, ...]:
    """Return a line if the ticks of a run are too long for the ground under its leg."""
    if run.leg is None:
        return ()
    haa, hfe, kfe = (run.leg.start.angle(joint) for joint, _ in run.leg.joints)
    time, step = contact_time(run.leg.sheet, (haa, hfe, kfe)), run.step_ns / NS_PER_SECOND
    if time >= LEAST_TICKS * step:
        return ()
    fine = next((step_ms for step_ms in _STEPS_MS if time >= ENOUGH_TICKS * step_ms * MILLI),
                _STEPS_MS[-1])
    return (
        f'{run.source}: on the ground of the leg, stiffness = {run.leg.sheet.ground.stiffness:g} '
        f'N/m^1.5, an impact lasts {time / MILLI:.2g} ms, {time / step:.2g} ticks of step_ms = '
        f'{step / MILLI:g}: its peak forces may be several percent wrong; use step_ms: {fine:g} '
        '(docs/impacts.md)',)
