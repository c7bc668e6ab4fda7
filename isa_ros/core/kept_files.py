"""
Files of a cache of machine code: each is whole or not there.

No lock is needed: a file is written aside and then renamed, and two processes that make the same
file write the same but for names within. One that nobody has used for long is swept.
"""

import contextlib
from functools import cache
import hashlib
import os
from pathlib import Path
import tempfile
import time

_NOTED_AFTER = 600.0        # s; a use that soon after the one before is not noted
_KEPT_TIME = 30 * 86400.0   # s, since a file was last read
_KEPT_BYTES = 512 << 20     # about thirty times the kernels of this package
_DIGEST_BYTES = 16


def _check(name: str, body: bytes | memoryview) -> bytes:
    """Return the digest by which a damaged or renamed file is noticed."""
    check = hashlib.blake2b(name.encode(), digest_size=_DIGEST_BYTES)
    check.update(body)
    return check.digest()


def read_kept(path: Path) -> memoryview | None:
    """Return what a file holds, None if there is none or it is damaged."""
    try:
        data = path.read_bytes()
        used = path.stat().st_mtime
    except OSError:
        return None
    body = memoryview(data)[_DIGEST_BYTES:]
    if _check(path.name, body) != data[:_DIGEST_BYTES]:
        return None
    if time.time() - used > _NOTED_AFTER:
        with contextlib.suppress(OSError):
            os.utime(path)      # the time of last use, for `_sweep`
    return body


def write_kept(path: Path, body: bytes) -> None:
    """
    Write a file aside and put it in place; its directory is made if need be, and swept.

    Raises
    ------
    OSError
        It cannot be written; nothing is left of it.

    """
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    handle, aside = tempfile.mkstemp(prefix='.', suffix='.part', dir=path.parent)
    try:
        with os.fdopen(handle, 'wb') as file:
            file.write(_check(path.name, body) + body)
        os.replace(aside, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(aside)
        raise
    _sweep(path.parent)


@cache
def _sweep(directory: Path) -> None:
    """Delete, once in a process, files not used for long, and the longest unused beyond a size."""
    earlier_form = directory.parent.glob('[0-9a-f]' * 16 + '/*/*.nb[ci]')
    found = []
    for path in (*directory.iterdir(), *earlier_form):
        with contextlib.suppress(OSError):
            status = path.stat()
            found.append((status.st_mtime, status.st_size, path))
    oldest, total = time.time() - _KEPT_TIME, 0
    for used, size, path in sorted(found, reverse=True):
        total += size
        if used < oldest or total > _KEPT_BYTES:
            with contextlib.suppress(OSError):
                path.unlink()
