"""Recording processes that are killed: the bag reads, replays, and lacks at most a second."""

from pathlib import Path
import random
import signal
import subprocess
import sys

from isa_ros.bag.reader import Bag
from isa_ros.bag.storage import Storage
from isa_ros.cli.main import main
from isa_ros.core.timebase import NS_PER_SECOND
import pytest
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
FIRST, LAST = 700, 1700  # ticks of 1 ms: chunks of 0.5 s, files of one chunk
RECORD = """
from dataclasses import replace
from pathlib import Path
import sys

from isa_ros.bag.provenance import installed_versions, Provenance
from isa_ros.bag.writer import BagWriter
from isa_ros.config.runs.run_file import load_run
from isa_ros.run.local_run import LocalRun
from isa_ros.scenario.scenario import load_scenario
from isa_ros.tick.source import ScheduledSource

out, compression, split_mb = sys.argv[1:]
scenario = load_scenario('config/scenarios/trot.yaml', load_run('config/rig_rotary.yaml').stored(
    compression, float(split_mb), 'the test'))
local = LocalRun(scenario.run)


class Telling:
    def write_tick(self, t_ns, sequence, messages):
        bag.write_tick(t_ns, sequence, messages)
        print(sequence, flush=True)


with BagWriter(Path(out), local.topics, Provenance(
        scenario.run.to_yaml(), scenario.to_yaml(), 0, installed_versions()),
        storage=scenario.run.record.storage) as bag:
    local.simulate(1_000_000, ScheduledSource(scenario.commands), Telling())
"""


def killed_recording(out: Path, storage: Storage, tick: int) -> int:
    """Kill a recording process once it has recorded ``tick``; return its last one."""
    process = subprocess.Popen(
        [sys.executable, '-c', RECORD, out, storage.compression, str(storage.split_mb)],
        cwd=ROOT, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        for line in process.stdout:
            if int(line) >= tick:
                break
        else:
            pytest.fail(f'ended by itself with {process.wait()}')
        process.kill()
        told = [line, *process.stdout.readlines()]
    finally:
        process.kill()
        process.stdout.close()
    assert process.wait(60) == -signal.SIGKILL
    return int([line for line in told if line.endswith('\n')][-1])


@pytest.mark.parametrize('compression, split_mb, seed', [
    ('none', 0.0, 1), ('none', 0.0, 2), ('zstd', 0.0, 3), ('zstd', 0.1, 4), ('lz4', 0.1, 5)])
def test_killed_recording_reads_and_replays(tmp_path, capsys, compression, split_mb, seed):
    """The tick is random; the place of the kill within its chunk depends on the machine."""
    tick = random.Random(seed).randint(FIRST, LAST)
    storage = Storage(compression=compression, split_mb=split_mb)
    last = killed_recording(tmp_path / 'bag', storage, tick)
    bag = Bag(tmp_path / 'bag')
    sequences = [found.sequence for found in bag.ticks()]
    assert sequences == list(range(len(sequences)))
    assert last * 1_000_000 - bag.end_ns <= NS_PER_SECOND
    assert not bag.is_whole
    assert (len(list((tmp_path / 'bag').glob('*.mcap'))) > 1) == bool(split_mb)
    assert main(['replay', str(tmp_path / 'bag')]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith(f'equal: {len(sequences)} ticks, {bag.n_messages} messages')
    assert lines[1] == 'the bag was cut short there'
    assert main(['recover', str(tmp_path / 'bag')]) == 0
    recovered = tmp_path / 'bag_recovered'
    assert main(['replay', str(recovered)]) == 0
    with AnyReader([recovered]) as reader:
        assert reader.message_count == bag.n_messages
    assert 'cut short' not in capsys.readouterr().out


def test_files_before_the_last_are_whole_for_other_readers(tmp_path):
    """The listed files exist, and all but the last one open in the official reader."""
    killed_recording(tmp_path / 'bag', Storage(compression='zstd', split_mb=0.1), FIRST)
    files = sorted((tmp_path / 'bag').glob('*.mcap'))
    for path in files[:-1]:
        with Reader(path) as reader:
            assert reader.message_count == Bag(path).n_messages > 0
    assert len(files) > 1
