"""
Threads of OpenBLAS, which NumPy and SciPy of PyPI each bring: where no code of a user runs, none.

As it is loaded, each begins one for every further core, and these spin before they sleep. The
matrices of this package are small. Those of a user's controllers and bodies need not be, and with
other threads the last bits of a product may be others: a run keeps the threads that it would have
in a program of the user.
"""

from collections.abc import MutableMapping
import os

VARIABLE = 'OPENBLAS_NUM_THREADS'
NAMES = VARIABLE, 'GOTO_NUM_THREADS', 'OMP_NUM_THREADS', 'OPENBLAS_DEFAULT_NUM_THREADS'


def without_threads(environment: MutableMapping[str, str] = os.environ) -> None:
    """
    Let OpenBLAS begin no threads where it is not loaded yet: in this process and those it starts.

    What the user has set stays, by any of the names that OpenBLAS knows.
    """
    if not any(map(environment.get, NAMES)):
        environment[VARIABLE] = '1'
