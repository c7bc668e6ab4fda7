"""
Setpoints that the sliders of a page move, one event for each drag.

A slider that is dragged sends some ten setpoints a second. Each is in the bag where it takes
effect; as an event of the run counts the last one of them, once the slider has stood still.
"""

import math
from typing import NamedTuple

from isa_ros.run.events import page_event

STILL_S = 0.5
"""Host time after which a drag has ended."""


class _Move(NamedTuple):
    """The last setpoint of a drag."""

    told: str
    tick: int
    at: float


class Drags:
    """The drags that have not ended; ``now`` is the host time, s."""

    def __init__(self) -> None:
        self._moved: dict[tuple[str, str], _Move] = {}

    def move(self, of: str, name: str, told: str, tick: int, now: float) -> None:
        """Note that a setpoint was sent before a tick; ``told`` is the answer to it."""
        self._moved[of, name] = _Move(told, tick, now)

    def ended(self, now: float = math.inf) -> list[str]:
        """Return the events of the drags that have ended since the last call; without now all."""
        over = [key for key, own in self._moved.items() if now - own.at >= STILL_S]
        return [page_event(own.told, own.tick) for own in map(self._moved.pop, over)]
