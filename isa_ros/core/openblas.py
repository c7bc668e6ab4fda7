"""
Threads of OpenBLAS, which NumPy and SciPy each bring: a program of this package needs none.

As it is loaded, each begins one for every core, and these spin before they sleep: on two cores
0.1 s of processor time for each process of a run. The matrices here are small.
"""

from collections.abc import MutableMapping
import os

VARIABLE = 'OPENBLAS_NUM_THREADS'
_OTHER_NAMES = 'GOTO_NUM_THREADS', 'OMP_NUM_THREADS'


def without_threads(environment: MutableMapping[str, str] = os.environ) -> None:
    """
    Let OpenBLAS begin no threads where it is not loaded yet: in this process and those it starts.

    What the user has set stays.
    """
    if not any(environment.get(name) for name in _OTHER_NAMES):
        environment.setdefault(VARIABLE, '1')
