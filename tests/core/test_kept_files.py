"""Files of a cache: whole or not there, and swept when they are old or too much."""

from collections.abc import Mapping
import os
from pathlib import Path
import time

from isa_ros.core import kept_files
from isa_ros.core.kept_files import read_kept, write_kept
import pytest


def filled(directory: Path, sizes_and_days: Mapping[str, tuple[int, float]]) -> None:
    """Make files of these sizes that were used so many days ago."""
    for name, (size, days) in sizes_and_days.items():
        path = directory / name
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open('wb') as file:
            file.truncate(size)     # takes no room
        used = time.time() - days * 86_400.0
        os.utime(path, (used, used))


def test_what_is_old_or_too_much_is_swept(tmp_path: Path) -> None:
    """The earlier form had a directory for each state of the sources; other files stay."""
    earlier = '0123456789abcdef/plant/valve.nbc'
    filled(tmp_path, {
        'kernels/used': (100, 29.9), 'kernels/unused': (100, 30.1), 'kernels/.part': (100, 31.0),
        earlier: (100, 31.0), 'other/file': (100, 99.0)})
    kept_files._sweep.__wrapped__(tmp_path / 'kernels')
    left = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob('*') if path.is_file()}
    assert left == {'kernels/used', 'other/file'}
    filled(tmp_path, {f'kernels/{days}': (200 << 20, days) for days in (1, 2, 3)})
    kept_files._sweep.__wrapped__(tmp_path / 'kernels')
    assert {path.name for path in (tmp_path / 'kernels').iterdir()} == {'1', '2'}


def test_a_directory_is_swept_when_something_is_written(tmp_path: Path) -> None:
    filled(tmp_path, {'kept/used': (100, 29.9), 'kept/unused': (100, 30.1)})
    write_kept(tmp_path / 'kept' / 'new', b'code')
    assert {path.name for path in (tmp_path / 'kept').iterdir()} == {'used', 'new'}


def test_what_is_written_is_read_by_its_name_alone(tmp_path: Path) -> None:
    path = tmp_path / 'made' / 'a'
    assert read_kept(path) is None
    write_kept(path, b'code')
    assert read_kept(path) == b'code' and path.parent.stat().st_mode & 0o777 == 0o700
    other = path.replace(path.with_name('b'))
    assert (read_kept(path), read_kept(other)) == (None, None)
    write_kept(path, b'')
    assert read_kept(path) == b''


def test_what_cannot_be_put_in_place_leaves_nothing(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(old: str, new: Path) -> None:
        raise OSError(28, 'full')
    monkeypatch.setattr(os, 'replace', refuse)
    with pytest.raises(OSError, match='full'):
        write_kept(tmp_path / 'a', b'code')
    assert list(tmp_path.iterdir()) == []
