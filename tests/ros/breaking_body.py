"""A body that waits for a file at its third tick, and is nowhere after its fifth."""

import os
from pathlib import Path

import isa_ros
import numpy as np
from tests.ros.started import wait_for
from tests.surroundings.mass_on_spring import MassOnSpring

WAITS_FOR = 'BREAKING_BODY_WAITS_FOR'
"""Environment variable with the path of the file."""
STEP = 1e-3


class Breaking(MassOnSpring):
    """Counts its ticks by its state; made once for a run."""

    made = 0

    def __init__(self, mounting: isa_ros.Mounting) -> None:
        super().__init__(mounting)
        Breaking.made += 1
        assert Breaking.made == 1, 'made twice'
        self.state = np.zeros(3)

    def motion(self, state: np.ndarray, forces: np.ndarray) -> isa_ros.Motion:
        """Return a motion; from the fifth tick without acceleration."""
        own = super().motion(state[:2], forces)
        if state[2] < 4.5:
            return own
        return own._replace(acceleration=np.array([own.acceleration[0], np.nan]))

    def stepped(self, state: np.ndarray, forces: np.ndarray, seconds: float) -> np.ndarray:
        """Return the next state."""
        if state[2] == 3.0:
            wait_for(Path(os.environ[WAITS_FOR]).exists, 'the file')
        return np.array([*super().stepped(state[:2], forces, seconds), state[2] + 1.0])
