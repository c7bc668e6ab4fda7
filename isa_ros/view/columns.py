"""The channels of a page in the rows of a run, as one vector at each tick."""

from collections.abc import Mapping, Sequence

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.record import floats
from isa_ros.core.signals import Records
from isa_ros.tick.exchange import Rows
import numpy as np
from numpy.typing import NDArray

_FLOAT_BYTES = 8


class Columns:
    """Where the channels of a page are in the rows of a run, the same memory over all ticks."""

    def __init__(self, run: RunConfig, rows: Rows, channels: Sequence[str]) -> None:
        of: dict[str, tuple[Records, int]] = {
            own.name: (rows.samples, k) for k, own in enumerate(run.actuators)}
        of |= {own.name: (rows.supplies, k) for k, own in enumerate(run.sampled_supplies)}
        of |= {name: (own, 0) for name, own in rows.bodies.items()}
        parts: dict[int, tuple[Records, list[int], list[int]]] = {}
        for place, channel in enumerate(channels):
            source, _, column = channel.rpartition('.')
            memory, row = of[source]
            _, into, found = parts.setdefault(id(memory), (memory, [], []))
            into.append(place)
            found.append(row * (memory.itemsize // _FLOAT_BYTES) + _column(memory, column))
        self._parts = [(floats(memory).reshape(-1), np.array(into), np.array(found))
                       for memory, into, found in parts.values()]

    def fill(self, row: NDArray[np.float32]) -> None:
        """Write the channels as they are now, (n_channels,)."""
        for memory, into, found in self._parts:
            row[into] = memory[found]


def _column(memory: Records, column: str) -> int:
    """Return the place of a number in a record: ``height``, or ``position[2]``."""
    field, _, place = column.partition('[')
    fields: Mapping[str, tuple[object, int]] = memory.dtype.fields or {}    # type: ignore
    return fields[field][1] // _FLOAT_BYTES + int(place.rstrip(']') or 0)
