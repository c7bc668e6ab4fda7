"""
A robot as the shared load of its actuators: ports down, forces up.

``x`` of a port is the load's side of the force sensor in the actuator's own coordinate: piston
position (m) or shaft angle (rad). Force > 0 pushes the actuator out.
"""

from collections.abc import Sequence
from dataclasses import fields
import math

from isa_ros.core.bound import Bound, Rebound
from isa_ros.core.parameter import Parameters
from isa_ros.core.record import float_columns
from isa_ros.core.saved_state import restored_body, saved_body
from isa_ros.core.signals import LOAD_REPLY
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError, RunError, SimulationDiverged
from isa_ros.surroundings.bodies.kernel_body import KernelBody
from isa_ros.surroundings.bodies.robot import stepping
from isa_ros.surroundings.bodies.robot.holding import holding_forces
from isa_ros.surroundings.bodies.robot.kept_forces import FIELDS, kept_part
from isa_ros.surroundings.bodies.robot.motion import scratch_size, state_names
from isa_ros.surroundings.bodies.robot.records import (
    contact_records, drive_records, link_records, RobotRecords, speed_records, unit_records)
from isa_ros.surroundings.bodies.robot.sample import sample_fields
from isa_ros.surroundings.bodies.robot.sheet import (
    JointLinkage, MovingPart, Push, RobotSheet, RobotStart, RobotUnit)
from isa_ros.surroundings.bodies.robot.unit_errors import changing_values, write_errors
from isa_ros.surroundings.inertial_unit import AXES
from isa_ros.surroundings.vectors import first_broken
import numpy as np

PUSHES = tuple(each.name for each in fields(Push))
ROUNDING = 1e-9     # of the length of a quaternion in a sheet


class Robot(KernelBody):
    """
    A tree of links on the ground under its actuators, advanced tick by tick: a `Body`.

    At t = 0 it is at rest, what the start holds is held, and the actuators carry the rest
    (`actuator_forces`). It is released before the tick that begins at ``release_ns``; None: by
    `release` alone. ``rows`` are those of its actuators, in the order of the sheet's drives. Each
    of the ``units`` keeps its reading in the sample until the next one. ``moving`` are the moving
    parts of its actuators; none: without mass.

    Raises
    ------
    ConfigError
        The start does not fit the sheet, or an actuator moves nothing there.

    """

    def __init__(self, sheet: RobotSheet, start: RobotStart, step_ns: int,
                 rows: Sequence[int] | None = None, release_ns: int | None = None,
                 units: Sequence[RobotUnit] = (), moving: Sequence[MovingPart] = ()) -> None:
        k = len(sheet.drives)
        super().__init__(
            step_ns, range(k) if rows is None else rows,
            sample_fields(sheet, [unit.name for unit in units]), release_ns)
        _refuse_start(sheet, start)
        self._units = units
        self._changing = changing_values(sheet.is_free, {
            own.name: own.errors for own in units if own.errors is not None}) or Parameters()
        self._names = state_names(sheet)
        self._ends_run = [own.name for own in sheet.contacts if own.ends_run]
        moving = moving or k * [MovingPart()]
        records = (link_records(sheet), speed_records(sheet, start), *drive_records(sheet),
                   contact_records(sheet))
        n = len(self._names)
        self._arrays = RobotRecords(
            *records, np.zeros(scratch_size(len(records[1]), k, n)))
        self._arrays.drives['moving_mass'] = [part.mass for part in moving]
        self._state = np.zeros(n + FIELDS * k + 1)
        values = self._sample.view(np.float64)
        columns = float_columns(self._sample.dtype)
        self._shown = (
            values, unit_records(units), np.array([unit.period_ns for unit in units], np.int64),
            values[len(values) - AXES * len(units):].reshape(-1, AXES),
            np.array([columns[f'{name}_touches'] for name in self._ends_run], np.int64))
        self.filling = Rebound(stepping.fill_ports, lambda ports: stepping.RobotPorts(
            self._clock, self._state, self.rows, self._arrays, ports))
        self.advancing = Rebound(stepping.advance, self._tick)
        self._start(sheet, start, moving)

    def _tick(self, replies: np.ndarray) -> stepping.RobotTick:
        """Return the memory of a tick with these replies."""
        return stepping.RobotTick(
            self._clock, self._state, self.rows, self._arrays, replies, *self._shown)

    def _start(self, sheet: RobotSheet, start: RobotStart,
               moving: Sequence[MovingPart]) -> None:
        y = self._motion
        at = 0
        if sheet.is_free:
            y[:3], y[3:7], at = start.position, start.quaternion, 7
        y[at:at + len(start.joints)] = start.joints
        self._state[-1] = 1.0
        forces = holding_forces(y, self._arrays, [own.actuator for own in sheet.drives])
        kept = kept_part(self._state, len(forces))
        kept.force[:] = kept.last_force[:] = forces
        kept.stretch[:] = forces / [part.cell_stiffness for part in moving]
        self._show = Bound(stepping.show, self._tick(np.zeros(0, LOAD_REPLY)))
        self._show.run()

    @property
    def _motion(self) -> np.ndarray:
        """Return y of the state, a view."""
        return self._state[:len(self._names)]

    @property
    def actuator_forces(self) -> np.ndarray:
        """Return the sensor forces (k,) the ports assume now; at t = 0 they hold the robot."""
        forces: np.ndarray = kept_part(self._state, len(self.rows)).force.copy()
        return forces

    @property
    def is_held(self) -> bool:
        """Return whether it has not been released."""
        return bool(self._state[-1])

    def starts(self, starts: np.ndarray) -> None:
        """Fill position (m | rad) and force (N | Nm) of its actuators' rows of `START`."""
        starts['position'][self.rows] = self._arrays.drives['position']
        starts['force'][self.rows] = self.actuator_forces

    def release(self) -> None:
        """Let everything go from the next tick on."""
        self._state[-1] = 0.0

    @property
    def changing(self) -> Parameters:
        """Return what may change during a run, as it is at its start (`changing_values`)."""
        return self._changing

    def change(self, values: Parameters) -> None:
        """Push the root, and let inertial units fail, from the next tick on."""
        if isinstance(values, Push):
            push = {name: getattr(values, name) for name in PUSHES}
            root = self._arrays.links[0]
            root['push_force'], root['push_moment'] = np.array(list(push.values())).reshape(2, 3)
            root['is_pushed'] = any(push.values())
        units, periods = self._shown[1:3]
        errors = getattr(values, 'imus', None)
        for k, own in enumerate(self._units):
            if own.errors is not None:
                write_errors(getattr(errors, own.name), np.ravel(own.rotation), own.period_ns,
                             units[k], periods[k:k + 1])

    def refuse(self, found: int) -> None:
        """Raise what `advancing` has found; 0: nothing."""
        self._refuse_broken(found - 1)
        if found < 0:
            raise RunError(
                f'{self._ends_run[-1 - found]} touches the ground at '
                f't = {self.t_ns / NS_PER_SECOND:g} s: with ends_run the robot has fallen')

    def _refuse_broken(self, at: int) -> None:
        """Raise `SimulationDiverged` for a place in the state that is not finite; -1: none is."""
        if at >= 0:
            name = (*self._names, 'force')[min(at, len(self._names))]
            raise SimulationDiverged(self.t_ns, f'robot.{name}', float(self._state[at]))

    def snapshot(self) -> bytes:
        """
        Return the whole state; `restore` continues from it byte for byte.

        Raises
        ------
        SimulationDiverged
            A number of the state is not finite.

        """
        self._refuse_broken(int(first_broken(self._state)))
        return saved_body(
            self.t_ns, self._state.view(self._saved_state), self._sample, 'robot')

    def restore(self, snapshot: bytes) -> None:
        """
        Continue from a `snapshot` of a robot with the same sheet and step.

        Raises
        ------
        ConfigError
            A number is not finite, or the time is not that of a tick.

        """
        t_ns, state, self._sample[:] = restored_body(
            snapshot, self._saved_state, self._sample.dtype, int(self._clock['step_ns'][0]),
            'robot')
        self._state[:] = state['state'][0]
        self._go_on_from(t_ns)

    @property
    def _saved_state(self) -> np.dtype[np.void]:
        return np.dtype([('state', '<f8', self._state.shape)])


def _refuse_start(sheet: RobotSheet, start: RobotStart) -> None:
    """Refuse a start of another number of joints, outside a range, or with a driven joint held."""
    if len(start.joints) != len(sheet.joints):
        raise ConfigError(f'the start has {len(start.joints)} joint coordinates, must have '
                          f'{len(sheet.joints)}')
    for joint, q in zip(sheet.joints, start.joints):
        if not (math.isfinite(q) and joint.low <= q <= joint.high):
            raise ConfigError(f'start of {joint.name} = {q:g}, must be within {joint.low:g}..'
                              f'{joint.high:g}')
    if sheet.is_free:
        w, x, y, z = start.quaternion
        length = math.sqrt(w * w + x * x + y * y + z * z)
        if not abs(length - 1.0) < ROUNDING:
            raise ConfigError(f'the quaternion of the start has length {length:g}, must be 1')
    names = [joint.name for joint in sheet.joints]
    for name in start.held_joints:
        if name not in names:
            raise ConfigError(f'held joint {name}, must be one of {", ".join(names)}')
    for drive in sheet.drives:
        if isinstance(drive.linkage, JointLinkage):
            name = names[drive.linkage.link - 1]
            if name in start.held_joints:
                raise ConfigError(f'{name} is held at the start, must have no actuator: '
                                  f'{drive.actuator} moves it')
