"""
A shorter start of a process that runs nothing but this package.

To offer matrix products in kernels, numba imports scipy.linalg, for about 0.2 s of processor
time. No kernel of this package multiplies matrices. A process in which somebody else's kernels
may be compiled must not be started this way.
"""

from importlib import import_module
import sys

_LOOKED_FOR = 'scipy'
_WHERE_NUMBA_LOOKS = 'numba.np.arraymath'


def start_without_blas() -> None:
    """Load numba's array functions as if scipy were not installed; scipy stays importable."""
    if _LOOKED_FOR in sys.modules or _WHERE_NUMBA_LOOKS in sys.modules:
        return
    import_module('numba')
    sys.modules[_LOOKED_FOR] = None  # type: ignore[assignment]
    try:
        import_module(_WHERE_NUMBA_LOOKS)
    finally:
        del sys.modules[_LOOKED_FOR]
