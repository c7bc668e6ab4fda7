"""Publishing at fewer ticks than are recorded."""

from collections.abc import Callable, Collection, Sequence

from isa_ros.core.topic import Topic

PeriodOf = Callable[[Topic], int]
"""Returns the period of a topic of the bag, ticks."""


def every_tick(topic: Topic) -> int:
    """Return the period of a topic of which nothing is left out."""
    return 1


class LivePeriods:
    """The periods of the topics of one source, in their order; ``topics`` as in the bag."""

    def __init__(self, period_of: PeriodOf, topics: Sequence[Topic]) -> None:
        self._periods = [period_of(topic) for topic in topics]
        self._is_thinned = any(period > 1 for period in self._periods)

    def due(self, tick: int, wanted: Collection[int] | None = None) -> Collection[int] | None:
        """Return the places of ``wanted`` topics (None: all) to publish at a tick."""
        if not self._is_thinned:
            return wanted
        return [slot for slot in (range(len(self._periods)) if wanted is None else wanted)
                if tick % self._periods[slot] == 0]
