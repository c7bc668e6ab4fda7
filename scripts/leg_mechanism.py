"""The leg as a mechanism: the same equations through the door as by its own port."""

import isa_ros
from isa_ros.config.runs.leg_config import LegConfig
from isa_ros.core.record import row_record
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.surroundings.bodies.leg.leg import Leg, LegPose
from isa_ros.surroundings.bodies.leg.motion import (
    actuator_accelerations, continuous, ContinuousState, Coordinates, joint_speeds, leg_motion,
    LEG_STATE, leg_step)
from isa_ros.surroundings.bodies.leg.port_kernel import shear_follow
from isa_ros.surroundings.bodies.leg.sheet import leg_record
import numpy as np

N = len(ContinuousState._fields)
_SPEEDS = 4     # z, haa, hfe, kfe


class LegMechanism:
    """
    The leg of a run file as a mechanism; its own last number is the time, s.

    Its slider is held until ``release``, as the leg's own port has it.
    """

    def __init__(self, config: LegConfig, mounting: isa_ros.Mounting) -> None:
        start = config.start
        leg = Leg(config.sheet, LegPose(
            haa=start.angle('haa'), hfe=start.angle('hfe'), kfe=start.angle('kfe'),
            foot_height=start.foot_height_mm * 1e-3), mounting.step_ns)
        self._leg = leg_record(config.sheet)[0]
        self._release = start.release_s - 0.5 / NS_PER_SECOND
        at_rest = row_record(np.frombuffer(leg.snapshot(), LEG_STATE, 1, 8))
        self.state = np.array([*continuous(at_rest), 0.0])

    def _of(self, state: np.ndarray) -> tuple[ContinuousState, bool]:
        *values, t = state.tolist()
        return ContinuousState(*values), t < self._release

    def motion(self, state: np.ndarray, forces: np.ndarray) -> isa_ros.Motion:
        """Return the motion of its three actuators."""
        (y, is_held), f = self._of(state), tuple(forces.tolist())
        now = leg_motion(y, f, is_held, self._leg)
        return isa_ros.Motion(
            np.array(now.position), np.array(now.lever) * joint_speeds(y),
            np.array(actuator_accelerations(y, f, is_held, self._leg)),
            np.array(now.acceleration))

    def displaced(self, state: np.ndarray, dq: np.ndarray, dv: np.ndarray) -> np.ndarray:
        """Return the state moved; the shear of the sole follows  (L14)."""
        y, _ = self._of(state)
        moved = state.copy()
        moved[:_SPEEDS] += dq
        moved[_SPEEDS:2 * _SPEEDS] += dv
        if dq.any():
            moved[2 * _SPEEDS:N] += shear_follow(y, Coordinates(*dq.tolist()), self._leg)
        return moved

    def stepped(self, state: np.ndarray, forces: np.ndarray, seconds: float) -> np.ndarray:
        """Return the state after a Runge-Kutta step for each fifth."""
        y, is_held = self._of(state)
        for row in forces.tolist():
            y = leg_step(y, seconds / len(forces), tuple(row), is_held, self._leg)
        return np.array([*y, state[N] + seconds])
