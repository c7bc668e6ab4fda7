"""Recording of a run: options, parameters, and a coordinator that is killed during it."""

import hashlib
from pathlib import Path
import signal

from isa_ros.bag.reader import Bag
from isa_ros.bag.storage import Storage
from isa_ros.cli.main import main
from isa_ros.config.runs.run_reading import run_of_text
import pytest
from rosbags.rosbag2 import Reader
from tests.ros.started import bringup, coordinator, LEG, RIG, wait_for

pytestmark = pytest.mark.ros

OPTIONS = ('--compression', 'zstd', '--split-mb', '0.01')  # every chunk has its own file


def digests(bag: Path) -> list[str]:
    return [hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(bag.glob('*.mcap'))]


def test_processes_and_one_process_give_equal_split_files(domain, tmp_path):
    bags = [tmp_path / 'several' / 'bag', tmp_path / 'one' / 'bag']
    for bag, options in zip(bags, [(), ('--in-process',)]):
        bag.parent.mkdir()
        with bringup(bag, '--duration', '0.8', *OPTIONS, *options, config=RIG) as run:
            assert run.exit_code() == 0, run.errors
    assert len(digests(bags[0])) == 2  # of 500 ticks, and of the rest
    assert digests(bags[0]) == digests(bags[1])
    with Reader(bags[0]) as reader:
        assert reader.message_count == Bag(bags[0]).n_messages


def test_parameters_of_the_coordinator_win_and_are_recorded(domain, tmp_path):
    config = tmp_path / 'rig.yaml'
    config.write_text(RIG.read_text() + (
        'record: {compression: zstd, split_mb: 3, leave_out: [/*/references]}\n'))
    bag = tmp_path / 'bag'
    with coordinator(tmp_path / 'log', config_file=config, out=bag, duration=0.1,
                     in_process=True, compression='lz4', split_mb=0.0) as run:
        assert run.exit_code() == 0, run.errors
    record = run_of_text(Bag(bag).provenance.configuration).record
    assert record.storage == Storage(compression='lz4', split_mb=0.0)
    assert record.leave_out == ('/*/references',)
    assert '/rotor/references' not in Bag(bag).types
    assert main(['replay', str(bag)]) == 0


def test_killed_coordinator_leaves_split_files_that_replay(domain, tmp_path, capsys):
    bag = tmp_path / 'bag'
    with bringup(bag, *OPTIONS, '--in-process', config=LEG) as run:
        wait_for(lambda: (bag / 'bag_2.mcap').exists() or not run.is_running(), 'a third file')
        run.signal(signal.SIGKILL)
        assert run.exit_code() == -signal.SIGKILL, run.errors
    assert not Bag(bag).is_whole
    assert main(['replay', str(bag)]) == 0
    assert 'the bag was cut short there' in capsys.readouterr().out
