"""Files that are replaced whole or not at all."""

import os
from pathlib import Path


def replace_file(path: Path, data: bytes, *, is_durable: bool) -> None:
    """
    Write a file; until all of it is written, the path leads to the one before, if there is one.

    ``is_durable`` also waits until the disk has it. A link at ``path`` is replaced, not followed.
    The temporary file is in the same directory; it is removed after an error.

    Raises
    ------
    OSError
        The file cannot be written, with its name; the one before is unchanged.

    """
    temporary = path.with_name(f'.{path.name}.tmp')
    temporary.unlink(missing_ok=True)  # of a killed process, or a link
    try:
        with temporary.open('xb') as file:
            file.write(data)
            if is_durable:
                file.flush()
                os.fsync(file.fileno())
        temporary.replace(path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise OSError(error.errno, error.strerror, str(path)) from error
    if is_durable:
        sync_directory(path.parent)


def sync_directory(directory: Path) -> None:
    """Wait until the disk has the names of a directory's files."""
    descriptor = os.open(directory, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
