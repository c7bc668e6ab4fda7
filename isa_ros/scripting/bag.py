"""Write the messages of a result: to its bag, or to another recorder."""

from pathlib import Path

from isa_ros.bag.provenance import provenance_of
from isa_ros.bag.writer import BagWriter
from isa_ros.core.signals import COMMAND
from isa_ros.core.topic import Topic
from isa_ros.run.exchange import Recorder
from isa_ros.run.narrator import Narrator, packer_of
from isa_ros.run.packing import Shown
from isa_ros.run.thinning import Thinning
from isa_ros.scripting.result import Result
import numpy as np


def save(result: Result, directory: Path, overwrite: bool) -> Path:
    """Write the bag of a result; as `Result.save`."""
    messages = ResultMessages(result)
    with BagWriter(directory, messages.topics, provenance_of(result.scenario), overwrite,
                   result.scenario.run.record.storage) as bag:
        messages.record(bag)
    return directory


class ResultMessages:
    """The messages of a result; ``topics`` are those of its bag, sorted by name."""

    def __init__(self, result: Result) -> None:
        self._result = result
        run, log = result.scenario.run, result.log
        self._shown = Shown(
            log.samples[0].copy(), np.zeros(len(run.actuators), COMMAND), log.supplies[0].copy(),
            None if log.body is None else log.body[:1].copy(),
            np.zeros(len(run.actuators), COMMAND))
        self._packer = packer_of(run, self._shown)
        self._thinning = Thinning(run.record, self._packer.topics)
        self.topics: tuple[Topic, ...] = tuple(self._thinning.topics)

    def record(self, recorder: Recorder) -> None:
        """Pass every sample to a recorder."""
        log, shown = self._result.log, self._shown
        samples = log.samples if log.observed is None else log.observed
        narrator = Narrator(
            self._packer, self._result.scenario.run.step_ns, self._thinning.recorder(recorder))
        for tick in range(len(samples)):
            shown.samples[:] = samples[tick]
            shown.supplies[:] = log.supplies[tick]
            if shown.body is not None and log.body is not None:
                shown.body[0] = log.body[tick]
            shown.applied['kinds'] = 0
            if tick in log.applied:
                shown.applied[:] = log.applied[tick]
            if shown.sent is not None:
                shown.sent['kinds'] = 0
                if tick in log.sent:
                    shown.sent[:] = log.sent[tick]
            narrator.publish_rows(
                tick, log.tuned.get(tick, {}), log.tuned_supplies.get(tick, {}))
            if tick < len(log.samples) - 1:
                narrator.record()
        narrator.end()
