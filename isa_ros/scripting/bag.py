"""Write the messages of a result: to its bag, or to another recorder."""

from collections.abc import Mapping
from pathlib import Path

from isa_ros.bag.writer import BagWriter
from isa_ros.config.assembly import surroundings_in_form
from isa_ros.core.topic import Topic
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.run.provenance import provenance_of
from isa_ros.run.recorders import Recorder
from isa_ros.run.thinning import Thinning
from isa_ros.scenario.scenario import Scenario
from isa_ros.scripting.log import Log
from isa_ros.tick.exchange import Rows


def save(
        scenario: Scenario, log: Log, bodies: Mapping[str, str], directory: Path,
        overwrite: bool) -> Path:
    """Write the bag of a result; as `Result.save`."""
    messages = ResultMessages(scenario, log)
    messages.refuse_misfits()
    with BagWriter(directory, messages.topics, provenance_of(scenario, bodies=bodies),
                   overwrite, scenario.run.record.storage) as bag:
        messages.record(bag)
    return directory


class ResultMessages:
    """The messages of a result; ``topics`` are those of its bag, sorted by name."""

    def __init__(self, scenario: Scenario, log: Log) -> None:
        self._log, self._run = log, scenario.run
        self._rows = Rows(len(self._run.actuators), surroundings_in_form(self._run))
        self._packer = packer_of(self._run, self._rows.published)
        self._thinning = Thinning(self._run.record, self._packer.topics)
        self.topics: tuple[Topic, ...] = tuple(self._thinning.topics)

    def refuse_misfits(self) -> None:
        """Refuse what `record` of the run leaves out; raises as `RecordConfig.refuse_misfits`."""
        self._run.record.refuse_misfits(
            [topic.name for topic in self._packer.topics], self._run.source)

    def record(self, recorder: Recorder) -> None:
        """Pass every sample to a recorder."""
        log, rows = self._log, self._rows
        samples = log.samples if log.observed is None else log.observed
        output = RunOutput(
            self._packer, self._run.step_ns, self._thinning.recorder(recorder))
        for tick in range(len(samples)):
            output.record()
            rows.samples[:] = samples[tick]
            rows.supplies[:] = log.supplies[tick]
            for name, sample in rows.bodies.items():
                for field in sample.dtype.names or ():
                    sample[field] = log.bodies[name][tick][field]
            for into, by_tick in ((rows.applied, log.applied), (rows.sent, log.sent)):
                into['kinds'] = 0
                if tick in by_tick:
                    into[:] = by_tick[tick]
            rows.tuned = log.tuned.get(tick, {})
            rows.tuned_supplies = log.tuned_supplies.get(tick, {})
            for text in log.events.get(tick, ()):
                output.add_event(tick, text)
            output.take(tick, rows)
        output.end()
