"""The counts of metadata.yaml against the messages that are in the files."""

from collections import Counter
from pathlib import Path
from typing import Any

from isa_ros.bag.storage import Storage
from mcap.reader import make_reader
import pytest
from tests.bag.recorded import NAMES, record, tick_messages
import yaml

N = 1101  # ticks: two full chunks and a part; setpoints are applied at every hundredth
SPLIT = pytest.mark.parametrize('split_mb', [0.0, 0.001], ids=['one file', 'a file per chunk'])


def recorded(directory: Path, split_mb: float) -> dict[str, Any]:
    """Record N ticks and return what metadata.yaml says."""
    record(directory, N, storage=Storage(compression='none', split_mb=split_mb))
    read = yaml.safe_load((directory / 'metadata.yaml').read_text())
    information: dict[str, Any] = read['rosbag2_bagfile_information']
    return information


def messages_in(path: Path) -> Counter[str]:
    """Return how many messages of each topic a file holds, by the official reader."""
    with path.open('rb') as file:
        return Counter(channel.topic for _, channel, _ in make_reader(file).iter_messages())


@SPLIT
def test_each_topic_is_counted_as_often_as_it_was_written(tmp_path: Path, split_mb: float):
    """By `message_count` of its entry: one a tick, but for what is applied now and then."""
    told = {topic['topic_metadata']['name']: topic['message_count']
            for topic in recorded(tmp_path / 'rig', split_mb)['topics_with_message_count']}
    written = Counter(NAMES[k] for tick in range(N) for k, _ in tick_messages(tick))
    assert told == written
    assert told['/hip/applied_setpoint'] == 12 and told['/clock'] == N


@SPLIT
def test_each_file_is_counted_with_what_is_in_it(tmp_path: Path, split_mb: float):
    """And all of them together by the count of the bag."""
    directory = tmp_path / 'rig'
    bag = recorded(directory, split_mb)
    found = {path.name: messages_in(path).total() for path in directory.glob('*.mcap')}
    assert len(found) == (3 if split_mb else 1)
    assert {file['path']: file['message_count'] for file in bag['files']} == found
    assert bag['message_count'] == sum(found.values())
