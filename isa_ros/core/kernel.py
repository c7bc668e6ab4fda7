"""
The decorator that compiles every kernel of this package.

numba's disk cache does not notice an edit in a function imported from another file: the
cached caller would silently run the old equation. The cache directory therefore carries a
hash of every kernel source, and any edit of one starts an empty cache.
"""

import hashlib
import os
from pathlib import Path

import numba

_PACKAGE = Path(__file__).parents[1]
_SOURCES = sorted(p for p in _PACKAGE.rglob('*.py') if b'@kernel' in p.read_bytes())
_DIGEST = hashlib.sha256(b'\0'.join(p.read_bytes() for p in _SOURCES)).hexdigest()[:16]

if 'NUMBA_CACHE_DIR' not in os.environ:
    numba.config.CACHE_DIR = str(  # type: ignore[attr-defined]
        Path.home() / '.cache' / 'isa_ros' / _DIGEST)

# No fastmath, no parallel: both may reorder roundings, and replay compares bytes. Functions that
# a kernel calls are inlined: a call costs as much as an equation, and inlining keeps every bit.
kernel = numba.njit(cache=True, nogil=True, error_model='numpy', forceinline=True)
