"""Whether a tick has a message of a device, bound to its memory."""

from typing import NamedTuple

from isa_ros.core.device import is_status_due
from isa_ros.core.kernel import kernel
import numpy as np


class DevicesDue(NamedTuple):
    """Memory of `is_any_due`."""

    samples: np.ndarray
    """`SAMPLE`, (n,)."""
    times: np.ndarray
    """End and begin of the tick, ns, int64, (2,)."""


@kernel
def is_any_due(own):
    """Return 1 if a tick has a message of the device of one of the samples, else 0."""
    for n in range(len(own.samples)):
        sample = own.samples[n]
        if is_status_due(sample.state_since, sample.age, sample.is_stale, own.times[0],
                         own.times[1]):
            return 1
    return 0
