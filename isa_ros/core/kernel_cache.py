"""
The directory in which compiled kernels are kept.

numba's disk cache does not notice an edit in a function imported from another file: the
cached caller would silently run the old equation. The directory therefore carries a hash of
every kernel source, wherever it is, and any edit of one starts an empty cache.

Nor does it lock: numba reads the index of a kernel's compiled versions, adds one and writes the
index back. Of two processes that do so at once, for different argument types, both may choose the
same file name, and a later process runs the code that was compiled for the other types.
"""

from collections.abc import Callable, Iterator
import contextlib
import fcntl
from functools import cache
import hashlib
import os
from pathlib import Path
import pickle
import stat
import sys
import tempfile
from typing import Any

import numba
from numba.core.caching import FunctionCache, NullCache

_PACKAGE = Path(__file__).parents[1]
_SOURCES = [Path(__file__).with_name('kernel.py'), *sorted(
    p for p in _PACKAGE.rglob('*.py') if b'@kernel' in p.read_bytes())]
_DIGEST = hashlib.sha256(b'\0'.join(p.read_bytes() for p in _SOURCES)).hexdigest()[:16]
_UNREADABLE = (OSError, EOFError, pickle.UnpicklingError)


def _candidates() -> Iterator[Path]:
    """Yield the directories that may hold the caches of all versions, the preferred one first."""
    for variable in ('NUMBA_CACHE_DIR', 'XDG_CACHE_HOME'):
        if os.environ.get(variable):
            yield Path(os.environ[variable]).absolute() / 'isa_ros'
    with contextlib.suppress(RuntimeError):  # no HOME, and a user without an entry in passwd
        yield Path.home() / '.cache' / 'isa_ros'
    with contextlib.suppress(FileNotFoundError):  # no temporary directory either
        yield Path(tempfile.gettempdir()) / f'isa_ros-{os.geteuid()}'


def _is_own(directory: Path) -> bool:
    """Return whether a directory can be used: nobody else may put code there that is run."""
    try:
        directory.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = directory.stat()
    except OSError:
        return False
    return (os.access(directory, os.W_OK | os.X_OK) and found.st_uid == os.geteuid()
            and not found.st_mode & stat.S_IWOTH)


def cache_directory() -> Path | None:
    """Return the directory of these kernels, None if no directory can be used."""
    for directory in _candidates():
        if _is_own(directory) and _is_own(directory / _DIGEST):
            return directory / _DIGEST
    return None


CACHE = cache_directory()
"""The directory of these kernels; None: they are compiled in every process."""


@cache
def _say_not_kept(reason: str) -> None:
    """Print one line, once in a process."""
    print(f'isa_ros: compiled kernels cannot be kept, {reason}: every start compiles them, for a '
          'minute or more; set NUMBA_CACHE_DIR to a directory of your own', file=sys.stderr)


class _NotKept(NullCache):
    """Keeps nothing, and says so at the first kernel that is compiled."""

    def save_overload(self, sig: Any, cres: Any) -> None:
        """Print the reason."""
        _say_not_kept('no directory is writable')


class _LockedCache(FunctionCache):
    """numba's disk cache, which only one process at a time adds to."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return a compiled version, None if there is none that can be read."""
        with contextlib.suppress(*_UNREADABLE):
            return super().load_overload(  # type: ignore[no-untyped-call]
                sig, target_context)
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Save one compiled version."""
        try:
            self._impl.locator.ensure_cache_path()
            directory = os.open(self.cache_path, os.O_RDONLY)
            try:
                fcntl.flock(directory, fcntl.LOCK_EX)
                super().save_overload(sig, data)  # type: ignore[no-untyped-call]
            finally:
                os.close(directory)
        except _UNREADABLE as error:
            _say_not_kept(getattr(error, 'strerror', None) or str(error))


def cache_of(function: Callable[..., Any], directory: Path | None) -> Any:
    """
    Return the cache of a kernel below a directory.

    numba's own setting is changed for this call only: a user's kernels have their own cache.
    """
    if directory is None:
        return _NotKept()
    config: Any = numba.config
    before = config.CACHE_DIR
    config.CACHE_DIR = str(directory)
    try:
        found: Any = _LockedCache(function)  # type: ignore[no-untyped-call]
    except RuntimeError:  # no directory that numba tries is writable
        return _NotKept()
    finally:
        config.CACHE_DIR = before
    # Beside the sources, numba's next choice, an edited equation would not be noticed.
    return found if directory in Path(found.cache_path).parents else _NotKept()
