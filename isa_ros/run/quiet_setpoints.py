"""Setpoints that quiet ticks apply, for the publishers of actuators in this process."""

from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.core.bound import Bound, nothing, Part
from isa_ros.core.kernel import kernel
from isa_ros.core.signals import COMMAND
from isa_ros.run.outlets import first_published, Outlet
from isa_ros.run.packing import Packer
from isa_ros.tick.planned import MOST
from msg_adapters.actuator_messages import APPLIED_PLACE
import numpy as np
from numpy.typing import NDArray


class Keeping(NamedTuple):
    """Memory of `keep_applied`."""

    n: NDArray[np.int64]
    """Number of ticks that are kept, (1,)."""
    applied: np.ndarray
    """`COMMAND` that took effect in the tick, (n_actuators,)."""
    kept: np.ndarray
    """Those of each tick, (`MOST`, n_actuators)."""


@kernel
def keep_applied(own):
    """Keep what took effect in a tick; return 0."""
    k = own.n[0]
    for row in range(len(own.applied)):
        own.kept[k, row] = own.applied[row]
    own.n[0] = k + 1
    return 0


class QuietSetpoints:
    """
    Publishes the applied setpoints of a call of quiet ticks, when it has ended.

    ``outlets`` are those of the actuators whose rows ``packer`` packs. Where nobody has
    subscribed until then these are the last ones, as a later subscription receives no others; one
    that comes while they are published may lack those before them.
    """

    def __init__(self, packer: Packer, outlets: Sequence[Outlet]) -> None:
        self._packer, self._outlets = packer, outlets
        applied = packer.applied
        self._own = Keeping(
            np.zeros(1, np.int64), applied, np.zeros((MOST, len(applied)), COMMAND))
        self._part = Part(Bound(keep_applied, self._own), nothing)

    def begin(self) -> tuple[int, Part]:
        """Return for how many ticks there is room, and what keeps their setpoints."""
        self._own.n[0] = 0
        return MOST, self._part

    def publish(self, tick: int, step_ns: int) -> None:
        """Publish what was applied in the ticks after ``tick``."""
        applied, kept = self._own.applied, self._own.kept[:self._own.n[0]]
        firsts = {row: first_published(self._outlets[row], len(kept))
                  for row in np.flatnonzero(kept['kinds'].any(axis=0)).tolist()}
        last = applied.copy()
        for k in range(min(firsts.values(), default=len(kept)), len(kept)):
            applied[:] = kept[k]
            t_ns = (tick + 1 + k) * step_ns
            self._packer.pack_numbers(t_ns, t_ns - step_ns)
            for row, first in firsts.items():
                if k >= first:
                    self._outlets[row].publish(self._packer.of_actuator(row, (APPLIED_PLACE,)))
        applied[:] = last
