"""Write the bag of a result."""

from pathlib import Path

from isa_ros.bag.provenance import provenance_of
from isa_ros.bag.writer import BagWriter
from isa_ros.core.signals import COMMAND
from isa_ros.run.narrator import Narrator, topics_of
from isa_ros.run.packing import Shown
from isa_ros.run.thinning import Thinning
from isa_ros.scripting.result import Result
import numpy as np


def save(result: Result, directory: Path, overwrite: bool) -> Path:
    """Write the bag of a result; as `Result.save`."""
    run, log = result.scenario.run, result.log
    shown = Shown(
        log.samples[0].copy(), np.zeros(len(run.actuators), COMMAND), log.supplies[0].copy(),
        None if log.body is None else log.body[:1].copy())
    thinning = Thinning(run.record, topics_of(run, shown))
    with BagWriter(directory, thinning.topics, provenance_of(result.scenario), overwrite,
                   run.record.storage) as bag:
        narrator = Narrator(run, shown, thinning.recorder(bag))
        for tick in range(len(log.samples)):
            shown.samples[:] = log.samples[tick]
            shown.supplies[:] = log.supplies[tick]
            if shown.body is not None and log.body is not None:
                shown.body[0] = log.body[tick]
            shown.applied['kinds'] = 0
            if tick in log.applied:
                shown.applied[:] = log.applied[tick]
            narrator.publish_rows(tick, {})
            narrator.record()
    return directory
