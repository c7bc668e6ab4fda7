"""
One leg as the shared load of three actuators: ports down, forces up.

``x`` of a port is the load's side of the force sensor in the actuator's own coordinate: piston
position (m) or shaft angle (rad). Rows of `LOAD_PORT` and `LOAD_REPLY` arrays belong to the
run's actuators; ``rows`` are the indices of those that drive HAA, HFE and KFE.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math

from isa_ros.core.timebase import FORCE_WINDOWS, NS_PER_SECOND, steps_in
from isa_ros.errors import ConfigError, SimulationDiverged
from isa_ros.surroundings.leg import port_kernel as kernels
from isa_ros.surroundings.leg.dynamics import leg_terms
from isa_ros.surroundings.leg.motion import LEG_STATE, STATE_NAMES, unpacked
from isa_ros.surroundings.leg.sheet import JOINTS, leg_records, LegSheet
from isa_ros.surroundings.linkage import actuator_coordinate
import numpy as np


@dataclass(frozen=True, kw_only=True)
class Pose:
    """Pose of a leg at rest at t = 0: joint angles (rad) and the foot's height (m)."""

    haa: float
    hfe: float
    kfe: float
    foot_height: float

    @property
    def joints(self) -> tuple[float, float, float]:
        """Return the joint angles in the order of `JOINTS`, rad."""
        return self.haa, self.hfe, self.kfe


class Leg:
    """
    Slider, three links and the ground, advanced tick by tick: a `Body`.

    At t = 0 the slider is held and the actuators carry the leg (`actuator_forces`); it is
    released before the tick that begins at ``release_ns``, None: by `release` alone.
    """

    def __init__(self, sheet: LegSheet, pose: Pose, step_ns: int,
                 rows: Sequence[int] = (0, 1, 2), release_ns: int | None = None) -> None:
        steps_in(step_ns // FORCE_WINDOWS, 'a fifth of step_ms')
        self._refuse_pose(sheet, pose)
        self._step_ns = step_ns
        self.rows = np.array(rows, np.int64)
        """Rows of the actuators that drive HAA, HFE and KFE, (3,)."""
        self._release_ns = release_ns
        self._body, self._linkages, self._ground = leg_records(sheet)
        self._state = np.zeros(1, LEG_STATE)
        self._flat = self._state.view(np.float64)
        self._sample = np.zeros(1, kernels.LEG_SAMPLE)
        self._flat_sample = self._sample.view(np.float64)
        self._look_ahead = 0.5 * step_ns / NS_PER_SECOND
        self._t_ns = 0
        self._is_to_be_released = release_ns is not None
        self._start(pose)

    @staticmethod
    def _refuse_pose(sheet: LegSheet, pose: Pose) -> None:
        if not (math.isfinite(pose.foot_height) and pose.foot_height >= 0.0):
            raise ConfigError(
                f'pose.foot_height = {pose.foot_height} m, must be >= 0 m: a held leg starts '
                'above the ground')
        for name, angle in zip(JOINTS, pose.joints):
            joint = getattr(sheet, name)
            if not joint.low_deg <= math.degrees(angle) <= joint.high_deg:
                raise ConfigError(
                    f'pose.{name} = {math.degrees(angle):g} deg, must be within '
                    f'{joint.low_deg:g}..{joint.high_deg:g} deg')

    def _start(self, pose: Pose) -> None:
        still = (0.0, 0.0, 0.0, 0.0)
        terms = leg_terms(0.0, *pose.joints, *still, self._body[0])
        state = self._state[0]
        state['z'] = pose.foot_height - terms.foot_z
        state['is_held'] = 1.0
        for k, name in enumerate(JOINTS):
            _, lever, _ = actuator_coordinate(pose.joints[k], self._linkages[k])
            state[f'q_{name}'] = pose.joints[k]
            for force in ('force', 'mean', 'older'):
                state[f'{force}_{name}'] = getattr(terms, f'h_{name}') / lever
        y, force, _, is_held = unpacked(self._flat)
        kernels.fill_sample(y, force, is_held, self._body[0], self._linkages, self._ground[0],
                            self._flat_sample)

    @property
    def t_ns(self) -> int:
        """Return the time the leg has reached, ns."""
        return self._t_ns

    @property
    def actuator_forces(self) -> tuple[float, float, float]:
        """Return the sensor forces (N | Nm) the ports assume now; at t = 0 they hold the leg."""
        state = self._state[0]
        return (float(state['force_haa']), float(state['force_hfe']), float(state['force_kfe']))

    @property
    def actuator_positions(self) -> tuple[float, float, float]:
        """Return the load's side of the three force sensors, m | rad."""
        x = [actuator_coordinate(float(self._state[f'q_{name}'][0]), self._linkages[k])[0]
             for k, name in enumerate(JOINTS)]
        return x[0], x[1], x[2]

    @property
    def sample(self) -> np.ndarray:
        """Return the `LEG_SAMPLE` at the end of the last tick, (1,); overwritten by the next."""
        return self._sample

    @property
    def units(self) -> Mapping[str, str]:
        """Return the unit of each field of the `LEG_SAMPLE`."""
        return kernels.LEG_UNITS

    @property
    def is_held(self) -> bool:
        """Return whether the slider is locked."""
        return bool(self._state['is_held'][0])

    def starts(self, starts: np.ndarray) -> None:
        """Fill position (m | rad) and force (N | Nm) of this leg's rows of `START`."""
        for row, x, force in zip(self.rows, self.actuator_positions, self.actuator_forces):
            starts[row]['position'], starts[row]['force'] = x, force

    def hold(self) -> None:
        """Lock the slider at its present height and set its speed to zero."""
        self._state['is_held'] = 1.0
        self._state['v_z'] = 0.0

    def release(self) -> None:
        """Let the slider go from the next tick on."""
        self._state['is_held'] = 0.0

    def ports(self, ports: np.ndarray) -> None:
        """
        Fill this leg's rows of ``ports`` (`LOAD_PORT`, shape (n_actuators,)) for the next tick.

        The pressures in them are left as they are.
        """
        if self._is_to_be_released and self._t_ns >= (self._release_ns or 0):
            self._is_to_be_released = False
            self.release()
        kernels.leg_ports(self._flat, self._look_ahead, self.rows, self._body, self._linkages,
                          self._ground, ports)

    def advance(self, replies: np.ndarray) -> None:
        """
        Advance by one tick under ``replies`` (`LOAD_REPLY`, shape (n_actuators,)).

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.

        """
        broken = kernels.leg_tick(
            self._flat, self._step_ns, self.rows, self._body, self._linkages, self._ground,
            replies.view(np.float64).reshape(-1, kernels.REPLY_WIDTH), self._flat_sample)
        self._t_ns += self._step_ns
        if broken >= 0:
            raise SimulationDiverged(
                self._t_ns, f'leg.{STATE_NAMES[broken]}', float(self._flat[broken]))

    def snapshot(self) -> bytes:
        """Return the whole state; `restore` continues from it byte for byte."""
        return (self._t_ns.to_bytes(8, 'little') + self._state.tobytes()
                + self._sample.tobytes())

    def restore(self, snapshot: bytes) -> None:
        """Continue from a `snapshot` of a leg with the same sheet and step."""
        self._t_ns = int.from_bytes(snapshot[:8], 'little')
        self._state[:] = np.frombuffer(snapshot, LEG_STATE, 1, 8)
        self._sample[:] = np.frombuffer(
            snapshot, kernels.LEG_SAMPLE, 1, 8 + self._state.nbytes)
        self._is_to_be_released = self._release_ns is not None and self.is_held
