"""Selection of the topics and samples to record, by the configuration of a run."""

from collections.abc import Sequence

from isa_ros.bag.packed import Packed
from isa_ros.config.runs.recording import RecordConfig
from isa_ros.core.topic import Topic
from isa_ros.run.recorders import Recorder


class Thinning:
    """Selects topics and their periods; ``topics`` are the recorded ones, in order."""

    def __init__(self, record: RecordConfig, topics: Sequence[Topic]) -> None:
        self._periods = [record.period(topic.name) for topic in topics]
        kept = [k for k, period in enumerate(self._periods) if period]
        self._places = {k: place for place, k in enumerate(kept)}
        self._is_needed = record.thins
        self.topics = [topics[k] for k in kept]

    def recorder(self, recorder: Recorder) -> Recorder:
        """Return a recorder that passes only the selected messages to ``recorder``."""
        if not self._is_needed:
            return recorder
        return _Thinned(recorder, self._periods, self._places)


class _Thinned:
    """Passes on the selected messages, with their indices among the recorded topics."""

    def __init__(
            self, recorder: Recorder, periods: Sequence[int], places: dict[int, int]) -> None:
        self._recorder = recorder
        self._periods = periods
        self._places = places

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """Pass on the selected messages of a tick, possibly none."""
        packed = Packed.of(messages)
        kept = [(place, self._places[k]) for place, k in enumerate(packed.layout.topics.tolist())
                if self._periods[k] and sequence % self._periods[k] == 0]
        self._recorder.write_tick(t_ns, sequence, packed.selected(
            [place for place, _ in kept], [topic for _, topic in kept]))
