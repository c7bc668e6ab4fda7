"""Whether requests of controllers need a look at each of them, bound to their memory."""

from typing import NamedTuple

from isa_ros.core.kernel import kernel
from isa_ros.core.signals import HAS_MODE, HAS_REFERENCE
import numpy as np

_OF_A_MODE = HAS_MODE | HAS_REFERENCE


class Requested(NamedTuple):
    """Memory of `is_unusual`; values are floats of rows, (n, floats)."""

    requests: np.ndarray
    """`COMMAND`, (n,)."""
    values: np.ndarray
    """The same memory as floats."""
    low: np.ndarray
    """Range of the values."""
    high: np.ndarray


@kernel
def is_unusual(own):
    """Return 1 if a value leaves its range, or a request is of a mode; else 0."""
    for n in range(len(own.requests)):
        if own.requests[n].kinds & _OF_A_MODE:
            return 1
        for k in range(own.values.shape[1]):
            value = own.values[n, k]
            if value < own.low[n, k] or value > own.high[n, k]:
                return 1
    return 0
