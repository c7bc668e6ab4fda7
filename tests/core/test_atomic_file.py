"""A file that is replaced: the old content or the new one, at any time and after any error."""

import errno
import os
from pathlib import Path

from isa_ros.core import atomic_file
from isa_ros.core.atomic_file import replace_file
import pytest
from tests.full_disk import limited_files


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Return a file with the content 'old'."""
    path = tmp_path / 'file'
    path.write_bytes(b'old')
    return path


def test_the_old_file_is_there_until_the_new_one_is_complete(
        path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And the new one is on the disk before its name is."""
    steps: list[tuple[str, bytes]] = []

    def noted(name: str, function):
        def note(*arguments):
            steps.append((name, path.read_bytes()))
            return function(*arguments)
        return note

    monkeypatch.setattr(os, 'fsync', noted('fsync', os.fsync))
    monkeypatch.setattr(Path, 'replace', noted('replace', Path.replace))
    replace_file(path, b'new', is_durable=True)
    assert steps == [('fsync', b'old'), ('replace', b'old'), ('fsync', b'new')]
    assert [each.name for each in path.parent.iterdir()] == ['file']


def test_a_full_disk_leaves_the_old_file_and_nothing_else(path: Path) -> None:
    with limited_files(2), pytest.raises(OSError, match='File too large'):
        replace_file(path, b'new', is_durable=True)
    assert path.read_bytes() == b'old'
    assert [each.name for each in path.parent.iterdir()] == ['file']


def test_what_a_killed_process_left_is_replaced(path: Path) -> None:
    path.with_name('.file.tmp').write_bytes(b'half')
    replace_file(path, b'new', is_durable=False)
    assert path.read_bytes() == b'new'
    assert [each.name for each in path.parent.iterdir()] == ['file']


def test_no_link_is_followed(path: Path, tmp_path: Path) -> None:
    outside = tmp_path / 'outside'
    outside.write_bytes(b'mine')
    path.unlink()
    path.symlink_to(outside)
    path.with_name('.file.tmp').symlink_to(outside)
    replace_file(path, b'new', is_durable=False)
    assert (path.read_bytes(), outside.read_bytes()) == (b'new', b'mine')
    assert not path.is_symlink()


def test_without_durability_the_disk_is_not_waited_for(
        path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(atomic_file.os, 'fsync', None)
    replace_file(path, b'new', is_durable=False)
    assert path.read_bytes() == b'new'


def test_an_error_has_the_name_of_the_file(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A full disk says so at a write, which has no name; the file before stays."""
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, 'No space left on device')
    monkeypatch.setattr(atomic_file.os, 'fsync', full)
    before = path.read_bytes()
    with pytest.raises(OSError) as raised:
        replace_file(path, b'new', is_durable=True)
    assert (raised.value.errno, raised.value.filename) == (errno.ENOSPC, str(path))
    assert path.read_bytes() == before and list(path.parent.iterdir()) == [path]
