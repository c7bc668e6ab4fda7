"""
One leg as the shared load of three actuators: ports down, forces up.

``x`` of a port is the load's side of the force sensor in the actuator's own coordinate: piston
position (m) or shaft angle (rad). Rows of `LOAD_PORT` and `LOAD_REPLY` arrays belong to the
run's actuators; ``rows`` are the indices of those that drive HAA, HFE and KFE.
"""

from collections.abc import Sequence
import math
from typing import NamedTuple

from isa_ros.core.bound import Bound, Rebound
from isa_ros.core.fields import Field
from isa_ros.core.frozen import frozen
from isa_ros.core.record import rows_of
from isa_ros.core.saved_state import restored_body, saved_body
from isa_ros.core.signals import LOAD_REPLY
from isa_ros.errors import ConfigError, SimulationDiverged
from isa_ros.surroundings.bodies.kernel_body import KernelBody
from isa_ros.surroundings.bodies.leg import stepping
from isa_ros.surroundings.bodies.leg.inertial import IMU, Imu, imu_record
from isa_ros.surroundings.bodies.leg.motion import continuous, ContinuousState, LEG_STATE, terms_of
from isa_ros.surroundings.bodies.leg.port_kernel import LEG_FIELDS, LEG_SAMPLE
from isa_ros.surroundings.bodies.leg.sheet import JOINTS, leg_record, LegSheet
from isa_ros.surroundings.inertial_unit import AXES, fields_of_unit
from isa_ros.surroundings.linkage import actuator_coordinate
import numpy as np


class InertialUnit(NamedTuple):
    """An inertial measurement unit of a leg."""

    name: str
    sheet: Imu
    period_ns: int
    """Of its readings, a multiple of the tick."""
    key: int
    """Of its noise."""


@frozen(kw_only=True)
class LegPose:
    """Pose of a leg at rest at t = 0: joint angles (rad) and the foot's height (m)."""

    haa: float
    hfe: float
    kfe: float
    foot_height: float

    @property
    def joints(self) -> tuple[float, float, float]:
        """Return the joint angles in the order of `JOINTS`, rad."""
        return self.haa, self.hfe, self.kfe


class Leg(KernelBody):
    """
    Slider, three links and the ground, advanced tick by tick: a `Body`.

    At t = 0 the slider is held and the actuators carry the leg (`actuator_forces`); it is
    released before the tick that begins at ``release_ns``, None: by `release` alone. Each of the
    ``units`` keeps its reading in the sample until the next one.
    """

    def __init__(self, sheet: LegSheet, pose: LegPose, step_ns: int,
                 rows: Sequence[int] = (0, 1, 2), release_ns: int | None = None,
                 units: Sequence[InertialUnit] = ()) -> None:
        super().__init__(
            step_ns, rows, sample_fields([unit.name for unit in units]), release_ns)
        self._refuse_pose(sheet, pose)
        self._constants = leg_record(sheet)
        self._state = rows_of(1, LEG_STATE)
        self._motion = self._sample.view(np.uint8)[:LEG_SAMPLE.itemsize].view(
            rows_of(1, LEG_SAMPLE).dtype)
        self._imus = np.array([imu_record(unit.sheet, unit.key) for unit in units], IMU)
        self._periods = np.array([unit.period_ns for unit in units], np.int64)
        self._readings = self._sample.view(np.uint8)[self._motion.nbytes:].view(
            np.float64).reshape(-1, AXES)
        self.filling = Rebound(stepping.fill_ports, lambda ports: stepping.LegPorts(
            self._clock, self._state, self._constants, self.rows, ports))
        self.advancing = Rebound(stepping.advance, self._tick)
        self._start(pose)

    def _tick(self, replies: np.ndarray) -> stepping.LegTick:
        """Return the memory of a tick with these replies."""
        return stepping.LegTick(
            self._clock, self._state, self._constants, self.rows, replies, self._motion,
            self._imus, self._periods, self._readings)

    @staticmethod
    def _refuse_pose(sheet: LegSheet, pose: LegPose) -> None:
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

    def _start(self, pose: LegPose) -> None:
        state, leg = self._state[0], self._constants[0]
        state.q_haa, state.q_hfe, state.q_kfe = pose.haa, pose.hfe, pose.kfe
        terms = terms_of(continuous(state), leg)
        state.z = pose.foot_height - terms.foot_z
        state.is_held = 1.0
        for k, name in enumerate(JOINTS):
            _, lever, _ = actuator_coordinate(pose.joints[k], leg[name])
            force = getattr(terms, f'h_{name}') / lever
            state.force[k] = state.mean_force[k] = state.older_mean[k] = force
        self._show = Bound(stepping.show, self._tick(np.zeros(0, LOAD_REPLY)))
        self._show.run()

    @property
    def actuator_forces(self) -> tuple[float, float, float]:
        """Return the sensor forces (N | Nm) the ports assume now; at t = 0 they hold the leg."""
        haa, hfe, kfe = self._state['force'][0].tolist()
        return haa, hfe, kfe

    @property
    def actuator_positions(self) -> tuple[float, float, float]:
        """Return the load's side of the three force sensors, m | rad."""
        haa, hfe, kfe = (
            actuator_coordinate(float(self._state[f'q_{name}'][0]), self._constants[0][name])[0]
            for name in JOINTS)
        return haa, hfe, kfe

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

    def refuse(self, found: int) -> None:
        """Raise what `advancing` has found; 0: nothing."""
        if found:
            name = ContinuousState._fields[found - 1]
            raise SimulationDiverged(self.t_ns, f'leg.{name}', float(self._state[name][0]))

    def snapshot(self) -> bytes:
        """
        Return the whole state; `restore` continues from it byte for byte.

        Raises
        ------
        SimulationDiverged
            A number of the state is not finite.

        """
        return saved_body(self.t_ns, self._state, self._sample, 'leg')

    def restore(self, snapshot: bytes) -> None:
        """
        Continue from a `snapshot` of a leg with the same sheet and step.

        Raises
        ------
        ConfigError
            A number is not finite, or the time is not that of a tick.

        """
        t_ns, self._state[:], self._sample[:] = restored_body(
            snapshot, LEG_STATE, self._sample.dtype, int(self._clock['step_ns'][0]), 'leg')
        self._go_on_from(t_ns)


def sample_fields(names: Sequence[str]) -> tuple[Field, ...]:
    """Return the fields of the sample of a leg with inertial units of these names."""
    readings = (('m/s2', 'in link axes'), ('rad/s', 'in link axes'))
    return (*LEG_FIELDS, *(
        Field(field, *reading, (3,))
        for name in names for field, reading in zip(fields_of_unit(name), readings)))
