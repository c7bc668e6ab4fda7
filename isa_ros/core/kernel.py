"""
The decorator that compiles every kernel of this package.

numba's disk cache does not notice an edit in a function imported from another file: the
cached caller would silently run the old equation. The cache directory therefore carries a
hash of every kernel source, and any edit of one starts an empty cache.

Nor does it lock: numba reads the index of a kernel's compiled versions, adds one and writes the
index back. Of two processes that do so at once, for different argument types, both may choose the
same file name, and a later process runs the code that was compiled for the other types.
"""

from collections.abc import Callable
import fcntl
import hashlib
import os
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core.caching import FunctionCache
from numba.extending import register_jitable

_Function = TypeVar('_Function', bound=Callable[..., Any])

_PACKAGE = Path(__file__).parents[1]
_SOURCES = sorted(p for p in _PACKAGE.rglob('*.py') if b'@kernel' in p.read_bytes())
_DIGEST = hashlib.sha256(b'\0'.join(p.read_bytes() for p in _SOURCES)).hexdigest()[:16]

if 'NUMBA_CACHE_DIR' not in os.environ:
    numba.config.CACHE_DIR = str(  # type: ignore[attr-defined]
        Path.home() / '.cache' / 'isa_ros' / _DIGEST)

# No fastmath, no parallel: both may reorder roundings, and replay compares bytes. Functions that
# a kernel calls are inlined: a call costs as much as an equation, and inlining keeps every bit.
_compile = numba.njit(nogil=True, error_model='numpy', forceinline=True)


class _LockedCache(FunctionCache):
    """numba's disk cache, which only one process at a time adds to."""

    def save_overload(self, sig: Any, data: Any) -> None:
        """Save one compiled version."""
        self._impl.locator.ensure_cache_path()
        directory = os.open(self.cache_path, os.O_RDONLY)
        try:
            fcntl.flock(directory, fcntl.LOCK_EX)
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]
        finally:
            os.close(directory)


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function for each combination of argument types, and keep that on disk."""
    compiled: Any = _compile(function)
    if compiled is not function:  # with NUMBA_DISABLE_JIT it is
        compiled._cache = _LockedCache(function)  # type: ignore[no-untyped-call]
    return compiled


def kernel_function(function: _Function) -> _Function:
    """Let kernels inline a plain function, which Python calls as it is."""
    register_jitable(error_model='numpy', forceinline=True)(function)
    return function
