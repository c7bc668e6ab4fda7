"""Write the messages of a result: to its bag, or to another recorder."""

from collections.abc import Mapping
from pathlib import Path

from isa_ros.bag.writer import BagWriter
from isa_ros.config.assembly import surroundings_in_form
from isa_ros.core.signals import Records
from isa_ros.core.topic import Topic
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.run.provenance import provenance_of
from isa_ros.run.recorders import Recorder
from isa_ros.run.thinning import Thinning
from isa_ros.scenario.scenario import Scenario
from isa_ros.scripting.log import Log
from isa_ros.scripting.quiet_log import QuietLog
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
        """Pass every sample to a recorder, by kernels wherever a tick has nothing unusual."""
        output = RunOutput(
            self._packer, self._run.step_ns, self._thinning.recorder(recorder))
        last, tick = len(self._samples) - 1, 0
        self._take(tick, output)
        quiet = QuietLog(self._log, self._rows, self._run.step_ns)
        while tick < last:
            # the last one is not for kernels: diagnostics end it
            tick += quiet.run(tick, last - 1 - tick, output) + 1
            output.record()
            self._take(tick, output)
        output.end()

    @property
    def _samples(self) -> Records:
        """Return the samples that listeners have."""
        return self._log.samples if self._log.observed is None else self._log.observed

    def _take(self, tick: int, output: RunOutput) -> None:
        """Take the rows and events of a sample."""
        log, rows = self._log, self._rows
        rows.samples[:] = self._samples[tick]
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
