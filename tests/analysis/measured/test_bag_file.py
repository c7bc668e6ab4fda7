"""The sqlite3 bags of rosbag2: their path is taken as it is, and damage is one line."""

from collections.abc import Sequence
from pathlib import Path
import sqlite3
from typing import Any

from isa_ros.analysis.measured.bag_file import read_fields
from isa_ros.bag.reader import Bag
from isa_ros.errors import BagError, ConfigError
import pytest
from tests.bag.golden import GOLDEN, rewrite

BAG = GOLDEN / 'rotor_step'
TOPIC, TYPE = '/rotor/load_cell', 'geometry_msgs/msg/WrenchStamped'
WANTED = {TOPIC: ['wrench.torque.z']}
GOOD = ((4, TOPIC, TYPE),)


@pytest.fixture(scope='module')
def data() -> list[bytes]:
    """Return some messages of the load cell."""
    own = Bag(BAG)
    assert own.types[TOPIC] == TYPE
    return [message.data for message in own.messages() if message.topic == TOPIC][:5]


def database(
        path: Path, messages: Sequence[tuple[Any, Any, Any]],
        topics: Sequence[tuple[Any, Any, Any]] = GOOD) -> Path:
    """Return a bag whose columns have no types, as a damaged one."""
    path.parent.mkdir(exist_ok=True)
    own = sqlite3.connect(path)
    own.execute('CREATE TABLE topics(id, name, type)')
    own.execute('CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data)')
    own.executemany('INSERT INTO topics VALUES (?, ?, ?)', topics)
    own.executemany('INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)', messages)
    own.commit()
    own.close()
    return path


@pytest.mark.parametrize('name', ['p%61.db3', 'da#1/x.db3', 'da?1/x.db3', 'a b.db3'])
def test_a_path_is_taken_as_it_is(tmp_path: Path, data: list[bytes], name: str) -> None:
    """Another bag has the name that a URI would make of it."""
    database(tmp_path / 'pa.db3', [(4, 10, data[0])])
    path = database(tmp_path / name, [(4, 7, data[0]), (4, 1_500_000_007, data[1])])
    before = sorted(tmp_path.rglob('*'))
    t, _ = read_fields(path, WANTED)[f'{TOPIC} wrench.torque.z']
    assert t.tolist() == [0.0, 1.5]
    assert sorted(tmp_path.rglob('*')) == before


def test_a_relative_path_is_read(
        tmp_path: Path, data: list[bytes], monkeypatch: pytest.MonkeyPatch) -> None:
    database(tmp_path / 'x.db3', [(4, 7, data[0]), (4, 2_000_000_007, data[1])])
    monkeypatch.chdir(tmp_path)
    assert read_fields(Path('x.db3'), WANTED)[f'{TOPIC} wrench.torque.z'][0][1] == 2.0


def test_a_bag_that_is_not_there_is_not_made(tmp_path: Path) -> None:
    with pytest.raises(BagError, match='none.db3: cannot be read: unable to open'):
        read_fields(tmp_path / 'none.db3', WANTED)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('row, expected', [
    ((7, 30, b'x'), 'message 3: topic_id = 7, is not one of its topics'),
    ((None, 30, b'x'), 'message 3: topic_id = None, is not one of its topics'),
    ((4, 30, None), 'message 3: data = None, must be bytes'),
    ((4, 30, 5), 'message 3: data = 5, must be bytes'),
    ((4, 30, 'text'), "message 3: data = 'text', must be bytes"),
    ((4, 'abc', b'x'), "message 3: timestamp = 'abc', must be a whole number"),
    ((4, None, b'x'), 'message 3: timestamp = None, must be a whole number'),
    ((4, 1e300, b'x'), 'message 3: timestamp = 1e+300, must be a whole number')])
def test_a_damaged_message_is_one_line(
        tmp_path: Path, data: list[bytes], row: tuple[Any, Any, Any], expected: str) -> None:
    path = database(tmp_path / 'bag.db3', [(4, 10, data[0]), (4, 20, data[1]), row])
    with pytest.raises(BagError) as refused:
        read_fields(path, WANTED)
    assert str(refused.value) == f'{path}: {expected}'


@pytest.mark.parametrize('topics, expected', [
    (((4, None, TYPE),), 'topic 4: name = None, must be text'),
    (((4, TOPIC, 5),), 'topic 4: type = 5, must be text'),
    ((*GOOD, (9, 3, TYPE)), 'topic 9: name = 3, must be text')])
def test_a_damaged_topic_is_one_line(
        tmp_path: Path, data: list[bytes], topics: Sequence[Any], expected: str) -> None:
    path = database(tmp_path / 'bag.db3', [(4, 10, data[0])], topics)
    with pytest.raises(BagError) as refused:
        read_fields(path, WANTED)
    assert str(refused.value) == f'{path}: {expected}'


def test_a_topic_without_messages_has_none(tmp_path: Path) -> None:
    path = database(tmp_path / 'bag.db3', [])
    with pytest.raises(ConfigError) as refused:
        read_fields(path, WANTED)
    assert str(refused.value) == f'{path}: the topic {TOPIC} has no messages in CDR'


def test_a_topic_without_messages_of_an_mcap_file_has_none(tmp_path: Path) -> None:
    bag = rewrite(Bag(BAG), tmp_path / 'less',
                  lambda topic, sequence, data: None if topic == TOPIC else data)
    with pytest.raises(ConfigError, match=f'the topic {TOPIC} has no messages in CDR'):
        read_fields(bag, WANTED)
