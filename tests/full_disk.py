"""A disk that is full, as a process sees it."""

from collections.abc import Iterator
from contextlib import contextmanager
import resource
import signal


@contextmanager
def limited_files(size: int) -> Iterator[None]:
    """Bound the size of files, as a full disk does; for the duration of the block only."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, handler)
