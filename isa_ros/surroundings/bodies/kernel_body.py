"""A body whose tick is kernels over a clock, a state and a sample."""

from collections.abc import Mapping, Sequence

from isa_ros.core.bound import Rebound
from isa_ros.core.fields import Field, record_type, units_of
from isa_ros.core.record import rows_of
from isa_ros.core.timebase import FORCE_WINDOWS, steps_in
from isa_ros.surroundings.clock import clock_of, NEVER
import numpy as np


class KernelBody:
    """
    What bodies of kernels share: time, sample, ports and ticks of a `BoundBody`.

    ``rows`` are those of its actuators, (k,), ``fields`` those of its sample. It is released
    before the tick that begins at ``release_ns``; None: by itself never.
    """

    filling: Rebound
    """Of the ports: fills them for the next tick."""
    advancing: Rebound
    """Of the replies: advances by one tick; what it returns is for `refuse`."""

    def __init__(
            self, step_ns: int, rows: Sequence[int], fields: Sequence[Field],
            release_ns: int | None) -> None:
        steps_in(step_ns // FORCE_WINDOWS, 'a fifth of step_ms')
        self.rows = np.array(rows, np.int64)
        """Rows of its actuators, (k,)."""
        self._release_ns = release_ns
        self._clock = clock_of(step_ns, release_ns)
        self._fields = tuple(fields)
        self._sample = rows_of(1, record_type(fields))

    @property
    def t_ns(self) -> int:
        """Return the time it has reached, ns."""
        return int(self._clock['t_ns'][0])

    @property
    def sample(self) -> np.ndarray:
        """Return the sample at the end of the last tick, (1,); overwritten by the next."""
        return self._sample

    @property
    def units(self) -> Mapping[str, str]:
        """Return the unit of each field of the sample."""
        return units_of(self._fields)

    @property
    def is_held(self) -> bool:
        """Return whether it has not been released."""
        raise NotImplementedError

    def ports(self, ports: np.ndarray) -> None:
        """
        Fill its rows of ``ports`` (`LOAD_PORT`, shape (n_actuators,)) for the next tick.

        The pressures in them are left as they are.
        """
        self.filling.to(ports).run()

    def advance(self, replies: np.ndarray) -> None:
        """
        Advance by one tick under ``replies`` (`LOAD_REPLY`, shape (n_actuators,)).

        Raises as `refuse`.
        """
        self.refuse(self.advancing.to(replies).run())

    def refuse(self, found: int) -> None:
        """
        Raise what `advancing` has found; 0: nothing.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.

        """
        raise NotImplementedError

    def _go_on_from(self, t_ns: int) -> None:
        """Continue from a state of this time, ns, that is in force."""
        self._clock['t_ns'] = t_ns
        self._clock['release_ns'] = (
            NEVER if self._release_ns is None or not self.is_held else self._release_ns)
