"""
The directory of a bag: where one may be created, and which files it may replace.

Only a bag of this package is replaced, and only the files that its metadata.yaml lists are
deleted. Other MCAP files beside them are never touched; with them in the directory the new bag
could not be distinguished from them, so nothing is replaced.
"""

import os
from pathlib import Path

from isa_ros.bag.metadata import FILE_NAME, own_files
from isa_ros.errors import BagError

_MCAP = '.mcap'
_MOST_BYTES = 255 - len(f'_9999{_MCAP}')
"""Of the name of a directory, so that file systems, which take 255, take its files' names."""


def make_directory(directory: Path, overwrite: bool) -> None:
    """
    Make the directory of a new bag; with ``overwrite`` the bag in it is removed.

    Raises
    ------
    BagError
        As `files_to_replace`, or the directory cannot be created or emptied.

    """
    try:
        for path in files_to_replace(directory, overwrite):
            path.unlink(missing_ok=True)
        directory.mkdir(parents=True, exist_ok=overwrite)
    except FileExistsError:
        raise _exists(directory) from None
    except OSError as error:
        raise BagError(f'{directory}: cannot be created, {error.strerror}') from None


def files_to_replace(directory: Path, overwrite: bool) -> list[Path]:
    """
    Return the files of the bag in a directory, metadata.yaml last; a new directory has none.

    Raises
    ------
    BagError
        There is a directory and ``overwrite`` is not set, or what is there is never replaced: it
        is not a bag of this package, or has MCAP files that do not belong to it. Or the name is
        too long for the files, which begin with it.

    """
    length = len(os.fsencode(directory.name))
    if length > _MOST_BYTES:
        raise BagError(
            f'{directory.parent / directory.name[:20]}...: the name has {length} bytes, must have '
            f'at most {_MOST_BYTES}; the files in it are named NAME_0{_MCAP}')
    if not directory.exists():
        return []
    if not directory.is_dir():
        raise BagError(f'{directory}: is a file, must be the name of a directory')
    if not any(directory.iterdir()):
        if not overwrite:
            raise _exists(directory, 'takes it, as it is empty')
        return []
    files = _files_of_bag(directory)
    if not overwrite:
        raise _exists(directory)
    return files


def _files_of_bag(directory: Path) -> list[Path]:
    """Return the files that may be deleted; raises as `files_to_replace`."""
    metadata = directory / FILE_NAME
    if not metadata.is_file():
        raise BagError(
            f'{directory} exists and is not a bag (no {FILE_NAME}), so it is not overwritten')
    names = own_files(metadata.read_bytes().decode('utf-8', 'replace'))
    if names is None:
        raise BagError(f'{metadata}: was not written by isa_ros, so nothing is overwritten')
    for name in names:
        if name != Path(name).name or not (name.isprintable() and name.endswith(_MCAP)):
            raise BagError(
                f'{metadata}: lists {name!r}, which is not an MCAP file beside it, so nothing is '
                'overwritten')
        if (directory / name).is_dir():
            raise BagError(f'{directory / name}: is a directory, so nothing is overwritten')
    strangers = sorted({path.name for path in directory.glob(f'*{_MCAP}')} - set(names))
    if strangers:
        raise BagError(
            f'{directory}: {", ".join(strangers)} not listed in {FILE_NAME}, so nothing is '
            'overwritten; move it to another directory')
    return [*(directory / name for name in names), metadata]


def _exists(directory: Path, what: str = 'replaces the bag in it') -> BagError:
    return BagError(
        f'{directory} already exists; --overwrite, in Python overwrite=True, {what}')
