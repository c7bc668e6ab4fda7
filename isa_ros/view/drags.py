"""
Setpoints that the sliders of a page move, one event for each drag.

A slider that is dragged sends some ten setpoints a second. Each is in the bag where it takes
effect; as an event of the run counts the last one of them, when the slider has stood still.
"""

from isa_ros.run.events import PAGE

STILL_S = 0.5
"""Host time after which a drag has ended."""


class Drags:
    """The drags that have not ended; ``now`` is the host time, s."""

    def __init__(self) -> None:
        self._moved: dict[tuple[str, str], tuple[str, float]] = {}

    def move(self, of: str, name: str, told: str, now: float) -> None:
        """Note that a setpoint of an actuator was sent; ``told`` is the answer to it."""
        self._moved[of, name] = told, now

    def clear(self) -> None:
        """Forget them all: the run begins at t = 0."""
        self._moved.clear()

    def ended(self, now: float) -> list[str]:
        """Return the events of the drags that have ended since the last call."""
        over = [key for key, (_, at) in self._moved.items() if now - at >= STILL_S]
        return [f'{PAGE}{self._moved.pop(key)[0]}' for key in over]
