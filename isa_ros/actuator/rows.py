"""The memory of the actuators of one process: a row each, so that one kernel call ticks all."""

from isa_ros.actuator import kernel as kernels
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY, SAMPLE
from isa_ros.reu.cascade import MEASURED, REU_STATE
import numpy as np


class ActuatorRows:
    """
    Arrays of ``n`` actuators, in the order of `kernels.actuator_tick` from ``is_shared`` on.

    `at` gives the same for one of them: views on its rows.
    """

    def __init__(self, n: int) -> None:
        bodies, rates = kernels.scratch(n)
        self.samples = np.zeros(n, SAMPLE)
        self.replies = np.zeros(n, LOAD_REPLY)
        self.arrays = (
            np.zeros(n, np.bool_), np.zeros(n, LOAD_PORT), np.zeros(n, kernels.ACTUATOR),
            bodies, rates, kernels.flat(bodies), kernels.flat(rates),
            np.zeros(n, REU_STATE), np.zeros(n, MEASURED), self.replies, self.samples)
        self._n = n

    def at(self, row: int) -> tuple[np.ndarray, ...]:
        """Return the arrays of one actuator."""
        return tuple(
            array[row * (len(array) // self._n):(row + 1) * (len(array) // self._n)]
            for array in self.arrays)
