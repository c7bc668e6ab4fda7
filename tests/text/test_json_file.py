"""Results as JSON: whole or not at all."""

import json
import resource

from isa_ros.text.json_file import write_tree
import pytest

LIMIT = 200     # bytes that a file may have, as on a full disk


@pytest.fixture
def full_disk():
    """Let no file become longer than `LIMIT`."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (LIMIT, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.parametrize('there', [None, {'a': 1}])
def test_a_full_disk_leaves_what_was_there(tmp_path, full_disk, there):
    path = tmp_path / 'numbers.json'
    if there is not None:
        write_tree(there, path)
    with pytest.raises(OSError, match='numbers.json'):
        write_tree(list(range(LIMIT)), path)
    assert [own.name for own in tmp_path.iterdir()] == ([] if there is None else [path.name])
    assert there is None or json.loads(path.read_text()) == there
