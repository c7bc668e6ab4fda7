"""Requests of controllers, checked against the ranges of their actuators at every tick."""

from collections.abc import Sequence
import math
from typing import NamedTuple

from isa_ros.actuator.setpoint_range import SetpointRange
from isa_ros.core.bound import Rebound
from isa_ros.core.kernel import kernel
from isa_ros.core.record import floats
from isa_ros.core.signals import COMMAND, HAS_MODE, HAS_REFERENCE, Records
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import SetpointError
import numpy as np

REPORT_NS = NS_PER_SECOND
"""Simulated time between two reports of requests to one actuator."""
REQUEST = "a controller's request, "
"""Begins the lines about requests beyond their range."""
_REFUSED = 'refused: '
_FLOAT_BYTES = 8
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


class RequestRange:
    """
    Checks what controllers request of the actuators of a run, at every tick.

    ``ranges`` are those of the actuators, in the order of the rows.
    """

    def __init__(self, ranges: Sequence[SetpointRange]) -> None:
        self._ranges = ranges
        self._low = np.full((len(ranges), COMMAND.itemsize // _FLOAT_BYTES), -math.inf)
        self._high = -self._low
        low, high = self._low.view(COMMAND)[:, 0], self._high.view(COMMAND)[:, 0]
        for row, own in enumerate(ranges):
            for field, bounds in own.bounds.items():
                low[field][row], high[field][row] = bounds.low, bounds.high
        self._next_report = [0] * len(ranges)
        self._is_beyond = Rebound(is_unusual, lambda requests: Requested(
            requests, floats(requests), self._low, self._high))

    def admit(self, t_ns: int, requests: Records) -> Sequence[str]:
        """
        Limit or delete the `COMMAND` rows (n_actuators,) of requests beyond the range, in place.

        Returns lines that report it, at most one in `REPORT_NS` per actuator. A request that is
        refused is deleted as a whole, with its enabling.
        """
        if not self._is_beyond.to(requests).run():
            return ()
        lines = []
        for row, own in enumerate(self._ranges):
            try:
                text = own.admit(requests[row])
            except SetpointError as error:
                text = f'{_REFUSED}{error}'
                requests[row] = np.zeros((), COMMAND)
            if text and t_ns >= self._next_report[row]:
                self._next_report[row] = t_ns + REPORT_NS
                lines.append(f'{REQUEST}{text}')
        return tuple(lines)


def request_told(line: str) -> tuple[str, str, bool] | None:
    """
    Return what a line of `RequestRange` tells: actuator, text, whether the request was refused.

    None: it is not such a line.
    """
    if not line.startswith(REQUEST):
        return None
    told = line.removeprefix(REQUEST)
    name, _, text = told.removeprefix(_REFUSED).partition(': ')
    return name, text, told.startswith(_REFUSED)
