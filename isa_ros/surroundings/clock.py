"""The clock of a body that is made of kernels: its time, its tick, and when it is released."""

from isa_ros.core.kernel import kernel
from isa_ros.core.timebase import NS_PER_SECOND
import numpy as np

CLOCK = np.dtype([
    ('t_ns', 'i8'),             # that the body has reached
    ('step_ns', 'i8'),          # of a tick
    ('step', 'f8'),             # likewise, s
    ('release_ns', 'i8'),       # it is released before the tick that begins then; -1: no more
])
NEVER = -1


def clock_of(step_ns: int, release_ns: int | None) -> np.ndarray:
    """Return the `CLOCK` at t = 0, (1,); None: it is not released by itself."""
    return np.array([(0, step_ns, step_ns / NS_PER_SECOND,
                      NEVER if release_ns is None else release_ns)], CLOCK)


@kernel
def is_released(clock):
    """Return whether a body is released before the next tick, once."""
    if clock.release_ns < 0 or clock.t_ns < clock.release_ns:
        return False
    clock.release_ns = NEVER
    return True
