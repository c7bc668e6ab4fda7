"""The instants of an actuator: its tick, and its samples between them."""

from isa_ros.core.frozen import frozen
from isa_ros.core.timebase import FORCE_WINDOWS, PLANT_STEP_NS, steps_in


@frozen
class Timing:
    """Tick, offset of the REU's sampling instants, ns; seed of noise; stamps at t = 0, ns."""

    step_ns: int
    controller_offset_ns: int
    seed: int = 0
    start_ns: int = 0

    @property
    def offset_steps(self) -> int:
        """Return the offset of the sampling instants in plant steps."""
        return self.controller_offset_ns // PLANT_STEP_NS

    @property
    def steps(self) -> int:
        """Return the plant steps of one tick, a multiple of the force windows."""
        return steps_in(self.step_ns // FORCE_WINDOWS, 'a fifth of step_ms') * FORCE_WINDOWS
