"""Which directories a bag is written to, and what is deleted there."""

from pathlib import Path

from isa_ros.bag.reader import Bag
from isa_ros.bag.storage import Storage
from isa_ros.bag.writer import BagWriter
from isa_ros.errors import BagError
import pytest
from rosbags.rosbag2 import Writer
from rosbags.rosbag2.enums import StoragePlugin
from rosbags.typesys import get_typestore, Stores
from tests.bag.recorded import contents, PROVENANCE, record, STEP_NS, TOPICS

SPLIT = Storage(compression='none', split_mb=0.001)


def refusal(directory: Path) -> str:
    """Return the message of a refused overwriting, which must leave every file as it was."""
    before = contents(directory)
    with pytest.raises(BagError) as refused:
        BagWriter(directory, TOPICS, PROVENANCE, overwrite=True)
    assert contents(directory) == before
    assert '\n' not in str(refused.value)
    return str(refused.value)


def recorded_by_rosbags(directory: Path, storage: StoragePlugin) -> Path:
    """Write a bag with another recorder."""
    store = get_typestore(Stores.ROS2_JAZZY)
    with Writer(directory, version=9, storage_plugin=storage) as writer:
        connection = writer.add_connection('/text', 'std_msgs/msg/String', typestore=store)
        writer.write(connection, 0, b'\0\1\0\0\2\0\0\0x\0')
    return directory


def test_an_existing_directory_is_refused_and_left_alone(tmp_path: Path) -> None:
    path = record(tmp_path / 'rig', 3)
    before = path.read_bytes()
    with pytest.raises(BagError, match='rig already exists; --overwrite, in Python over'):
        BagWriter(tmp_path / 'rig', TOPICS, PROVENANCE)
    assert path.read_bytes() == before


def test_an_empty_directory_has_no_bag_to_replace(tmp_path: Path) -> None:
    with pytest.raises(BagError, match='already exists; .*=True, takes it, as it is empty$'):
        BagWriter(tmp_path, TOPICS, PROVENANCE)
    assert not list(tmp_path.iterdir())
    record(tmp_path, 3, overwrite=True)
    assert Bag(tmp_path).end_ns == 2 * STEP_NS


def test_a_file_is_no_directory(tmp_path: Path) -> None:
    (tmp_path / 'rig').write_text('mine')
    for overwrite in (False, True):
        with pytest.raises(BagError, match='rig: is a file, must be the name of a directory$'):
            BagWriter(tmp_path / 'rig', TOPICS, PROVENANCE, overwrite=overwrite)
    assert (tmp_path / 'rig').read_text() == 'mine'


def test_overwriting_removes_the_bag_and_nothing_else(tmp_path: Path) -> None:
    directory = tmp_path / 'rig'
    record(directory, 1234, storage=SPLIT)
    assert len(list(directory.glob('*.mcap'))) == 3
    (directory / 'figure.png').write_bytes(b'png')
    (directory / 'state_7.json').write_bytes(b'{}')
    record(directory, 5, overwrite=True)
    assert sorted(contents(directory)) == [
        'figure.png', 'metadata.yaml', 'rig_0.mcap', 'state_7.json']
    assert Bag(directory).end_ns == 4 * STEP_NS


def test_the_files_of_a_renamed_bag_are_removed(tmp_path: Path) -> None:
    record(tmp_path / 'rig', 3)
    (tmp_path / 'rig').rename(tmp_path / 'other')
    record(tmp_path / 'other', 3, overwrite=True)
    assert sorted(contents(tmp_path / 'other')) == ['metadata.yaml', 'other_0.mcap']


def test_a_listed_file_may_be_missing(tmp_path: Path) -> None:
    record(tmp_path / 'rig', 3).unlink()
    record(tmp_path / 'rig', 3, overwrite=True)
    assert Bag(tmp_path / 'rig').is_whole


def test_another_mcap_file_beside_the_bag_is_never_deleted(tmp_path: Path) -> None:
    """With it in the directory the new bag could not be read either: it has no known order."""
    record(tmp_path / 'rig', 3)
    (tmp_path / 'rig' / 'thesis.mcap').write_bytes(b'data')
    (tmp_path / 'rig' / 'rig_1.mcap').write_bytes(b'another day')
    assert refusal(tmp_path / 'rig') == (
        f'{tmp_path / "rig"}: rig_1.mcap, thesis.mcap not listed in metadata.yaml, so nothing is '
        'overwritten; move it to another directory')


@pytest.mark.parametrize('storage', StoragePlugin)
def test_a_bag_of_another_recorder_is_never_deleted(
        tmp_path: Path, storage: StoragePlugin) -> None:
    directory = recorded_by_rosbags(tmp_path / 'mine', storage)
    assert len(contents(directory)) == 2
    assert refusal(directory) == (
        f'{directory}/metadata.yaml: was not written by isa_ros, so nothing is overwritten')


@pytest.mark.parametrize('text', [
    '', 'name: thesis\n', 'rosbag2_bagfile_information: {}\n', '\0\0', '- a\n- a\n'])
def test_a_metadata_file_of_something_else_is_never_deleted(tmp_path: Path, text: str) -> None:
    (tmp_path / 'metadata.yaml').write_text(text)
    (tmp_path / 'thesis.mcap').write_bytes(b'data')
    assert refusal(tmp_path).endswith('was not written by isa_ros, so nothing is overwritten')


@pytest.mark.parametrize('name', [
    '../thesis.mcap', '/thesis.mcap', 'a/b.mcap', 'notes.txt', '..', '', 'a\\u0000.mcap'])
def test_a_listed_file_elsewhere_is_never_deleted(tmp_path: Path, name: str) -> None:
    record(tmp_path / 'rig', 3).unlink()
    (tmp_path / 'thesis.mcap').write_bytes(b'data')
    (tmp_path / 'rig' / 'notes.txt').write_bytes(b'mine')
    metadata = tmp_path / 'rig' / 'metadata.yaml'
    metadata.write_text(metadata.read_text().replace('rig_0.mcap', name))
    assert 'which is not an MCAP file beside it' in refusal(tmp_path / 'rig')
    assert (tmp_path / 'thesis.mcap').read_bytes() == b'data'


def test_a_directory_in_place_of_a_listed_file_is_refused(tmp_path: Path) -> None:
    path = record(tmp_path / 'rig', 3)
    path.unlink()
    path.mkdir()
    with pytest.raises(BagError, match='rig_0.mcap: is a directory, so nothing is overwritten'):
        BagWriter(tmp_path / 'rig', TOPICS, PROVENANCE, overwrite=True)
    assert (tmp_path / 'rig' / 'metadata.yaml').is_file()


def test_a_directory_without_a_bag_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / 'thesis.mcap').write_bytes(b'data')
    assert 'is not a bag (no metadata.yaml)' in refusal(tmp_path)


def test_a_directory_that_cannot_be_made_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / 'file').write_bytes(b'')
    with pytest.raises(BagError, match='file/rig: cannot be created, Not a directory'):
        BagWriter(tmp_path / 'file' / 'rig', TOPICS, PROVENANCE)


@pytest.mark.parametrize('name', ['b' * 246, '\u00e9' * 123], ids=['letters', 'bytes'])
def test_a_name_that_its_files_cannot_have_is_refused_before_anything_is_made(tmp_path, name):
    """A file NAME_9999.mcap has 10 bytes more, and a file system takes 255."""
    with pytest.raises(BagError, match='the name has 246 bytes, must have at most 245; the files'):
        BagWriter(tmp_path / name, TOPICS, PROVENANCE)
    assert not [*tmp_path.iterdir()]
    record(tmp_path / name[:-1], 3)
    assert Bag(tmp_path / name[:-1]).is_whole
