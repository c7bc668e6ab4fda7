"""The example of docs/bag.md is what it says."""

from dataclasses import replace
from pathlib import Path

from isa_ros.config.runs.recording import RecordConfig
from isa_ros.run.local_run import LocalRun
from tests.docs.pages import actuators, example, run_of


def test_the_section_record_fits_the_run_file(tmp_path: Path) -> None:
    run = run_of(actuators() + example('bag', 'record:'), tmp_path)
    run.record.refuse_misfits(
        [topic.name for topic in LocalRun(replace(run, record=RecordConfig())).topics],
        run.source)
    assert (run.record.storage.compression, run.record.thins) == ('zstd', True)
