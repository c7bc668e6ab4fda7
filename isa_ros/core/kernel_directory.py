"""The directories in which compiled kernels are kept; finding them takes no compiler."""

from collections.abc import Iterator
import contextlib
import os
from pathlib import Path
import stat
import tempfile
from typing import Any

from isa_ros.core.kernel_key import kernel_digest


def _candidates() -> Iterator[Path]:
    """Yield the directories that may hold the caches of all versions, the preferred one first."""
    for variable in ('NUMBA_CACHE_DIR', 'XDG_CACHE_HOME'):
        if os.environ.get(variable):
            yield Path(os.environ[variable]).absolute() / 'isa_ros'
    with contextlib.suppress(RuntimeError):  # no HOME, and a user without an entry in passwd
        yield Path.home() / '.cache' / 'isa_ros'
    with contextlib.suppress(FileNotFoundError):  # no temporary directory either
        yield Path(tempfile.gettempdir()) / f'isa_ros-{os.geteuid()}'


def _is_trusted(directory: Path) -> bool:
    """Return whether nobody else may put code there that is run."""
    try:
        found = directory.stat()
    except OSError:
        return False
    return found.st_uid in (0, os.geteuid()) and not found.st_mode & stat.S_IWOTH


def _is_own(directory: Path) -> bool:
    """Return whether a directory can be written, and is trusted; it is made if need be."""
    with contextlib.suppress(OSError):
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
    return _is_trusted(directory) and os.access(directory, os.W_OK | os.X_OK)


def cache_directories() -> tuple[Path | None, tuple[Path, ...]]:
    """Return the directory to write to, None if there is none, and all to read from."""
    readable: list[Path] = []
    for directory in _candidates():
        place = directory / 'kernels'
        if _is_own(directory) and _is_own(place):
            return place, (*readable, place)
        if _is_trusted(directory) and _is_trusted(place):
            readable.append(place)
    return None, tuple(readable)


CACHE, READ = cache_directories()
"""The directory of kernels; None: those that no readable one holds are compiled every time."""


def digest_text(kernel: Any) -> str:
    """Return the digest of a kernel as names of files have it."""
    return kernel_digest(kernel).hex()[:32]


def is_kept(kernel: Any) -> bool:
    """Return whether a kernel as it is now is kept, for whatever types of arguments."""
    return any(True for place in READ for _ in place.glob(f'*-{digest_text(kernel)}'))
