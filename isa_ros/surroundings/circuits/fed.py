"""The manifolds of a circuit that feed actuators."""

import math
from typing import NamedTuple

from isa_ros.core.timebase import PLANT_STEP
from isa_ros.errors import ParameterError
from isa_ros.surroundings.supply_port import PORT_STEPS
import numpy as np


class Fed(NamedTuple):
    """One manifold that feeds actuators."""

    place: str
    flow_slope: float
    """Sum of their valves' largest dQ/dP, m3/s/Pa."""
    rows: tuple[int, ...] = ()
    """Rows of the fed actuators."""
    heated: tuple[int, ...] = ()
    """Of them those with a temperature of their own."""
    coldest: float = -math.inf
    """Least temperature of the oil that their steps can follow, celsius."""

    def refuse_small(self, node: np.record, name: str) -> None:
        """
        Refuse a `NODE` whose oil, without an accumulator, is too small to feed  (C16).

        Raises
        ------
        ParameterError
            With both times; ``name`` is that of the circuit.

        """
        holds, bound = float(node.c) / self.flow_slope, PORT_STEPS * PLANT_STEP
        if holds < bound:
            raise ParameterError(
                f'{name}: parts.{self.place}: capacity over flow slope of its actuators = '
                f'{holds * 1e3:.3g} ms, must be >= {bound * 1e3:.3g} ms (four plant steps); '
                'enlarge its oil_volume_l')
