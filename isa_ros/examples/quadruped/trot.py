"""
A trot by sharing a wrench and by capture points: a controller to copy and to replace.

At each tick, in this order:

1. The trunk is to be level, at a height, and to move at a speed and turn at a rate. A wrench about
   the centre of mass is proportional to the errors of these (`TrotGains`), plus the weight.
2. The standing feet share it by least squares, within a friction cone (`stance`).
3. A swinging foot goes to where the capture point calls for (Raibert 1986, ch. 2): beneath the
   place of its leg, ahead by half the way of a stance, and off by a part of sqrt(height/g) times
   the error of the speed. A spring and a damper pull it along its way (`gait`).
4. The forces of the feet become torques of the joints by the Jacobians (`legs`), plus those that
   hold the legs' weights; torques over levers are the efforts of the actuators, whose own
   stiffness and damping are 0.

**It reads the pose of the trunk and the angles of the joints as they are simulated**, from the
sample of the body: there is no estimation of the state, whose errors a real robot has to bear.
Positions, speeds and forces that the actuators measure are not used.
"""

from collections.abc import Mapping, Sequence
import math
import struct
from typing import Any

from isa_ros.actuator.setpoint_range import setpoint_bounds
from isa_ros.config.runs.robot_config import RobotConfig
from isa_ros.config.text.sections import Place
from isa_ros.controller import Controller, Setpoints, State
from isa_ros.core.bound import Bound
from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.core.elementary import cos, sin
from isa_ros.errors import ConfigError
from isa_ros.examples.quadruped.gait import Gait, swing, Swinging
from isa_ros.examples.quadruped.legs import Legs, paths_of
from isa_ros.examples.quadruped.parameters import (
    gains_of, PROGRAM, program_of, TrotGains, TrotProgram)
from isa_ros.examples.quadruped.stance import equations, share, Sharing, WEIGHTS
from isa_ros.surroundings.bodies.robot.sheet import RobotSheet
import numpy as np


class Trot(Controller):
    """
    Stands, squats and trots with a robot of four legs of three joints, as a `TrotProgram` says.

    ``efforts`` are the rated forces (N | Nm) of the actuators by their names in the sheet, least
    and most, ``names`` their names in the run; ``body`` is that of the robot in the state.

    Raises
    ------
    ConfigError
        The legs of the robot are not such (`Legs`).

    """

    def __init__(
            self, sheet: RobotSheet, names: Mapping[str, str],
            efforts: Mapping[str, tuple[float, float]], gains: TrotGains, program: TrotProgram,
            body: str = 'body') -> None:
        self._sheet, self._gains, self._program, self._body = sheet, gains, program, body
        self._legs = Legs(sheet)
        drives = {sheet.driven(drive)[0]: drive.actuator for drive in sheet.drives}
        self._drives = [drives[link] for link in self._legs.paths.ravel().tolist()]
        self._names = [names[drive] for drive in self._drives]
        self._least, self._most = np.array([efforts[drive] for drive in self._drives]).T
        self._joints = self._legs.paths.ravel() - 1
        self.start(self._names)

    @classmethod
    def of(cls, run: Any, values: Mapping[str, Any], where: str) -> 'Trot':
        """
        Return the controller of a section of a run file or scenario; as `Controller.of`.

        ``values`` are `TrotGains`, ``program``, a list of `Point`, and ``body``, the name of the
        robot where the run has several.
        """
        file, _, key = where.partition(': ')
        place, gains = Place(file, key), dict(values)
        program = program_of(gains.pop(PROGRAM, None), place / PROGRAM)
        robots = {own.name: own for own in run.bodies if isinstance(own, RobotConfig)}
        name = gains.pop('body', next(iter(robots), None))
        if name not in robots:
            raise ConfigError(f'{place / "body"} = {name!r}, must be a robot of the run: '
                              f'{", ".join(robots) or "it has none"}')
        robot = robots[name]
        try:
            paths_of(robot.sheet)
        except ConfigError as error:
            raise ConfigError(f'{place / "body"} = {name!r}: {error}') from error
        names = {drive.actuator: actuator
                 for drive, (_, actuator) in zip(robot.sheet.drives, robot.joints)}
        efforts = {drive: setpoint_bounds(run.actuator(own).sheet)['effort'][:2]
                   for drive, own in names.items()}
        return cls(robot.sheet, names, efforts, gains_of(gains, place), program, name)

    def start(self, names: Sequence[str]) -> None:
        """Begin anew at t = 0."""
        self._rows = [names.index(name) for name in self._names]
        self._gait = Gait(self._gains)
        self._t_ns = 0
        self._is_begun = False
        n = len(self._legs.paths)
        self._lifted = np.zeros((n, 3))
        self._forces = np.zeros((n, 3))
        self._bind(n)
        self._home = np.zeros((n, 2))
        self._anchor = np.zeros(2)
        self._heading = np.array([1.0, 0.0])
        self._drag = np.zeros(2)
        self._inertia = np.eye(3)
        self._columns: np.ndarray | None = None

    def _bind(self, n: int) -> None:
        """Bind the kernels of a tick with n feet to their memory."""
        gains, legs = self._gains, self._legs
        self._sharing = Sharing(
            np.zeros(6), np.zeros((n, 3)), np.ones(n, bool), WEIGHTS,
            np.array([gains.least_force, gains.most_force, gains.friction]), equations(n),
            self._forces)
        self._swinging = Swinging(
            np.zeros(6), np.zeros(n), np.array([self._gait.swing_s]), np.zeros((n, 2)),
            np.array([gains.lift, gains.press, gains.swing_stiffness, gains.swing_damping]),
            legs.feet, legs.velocities, self._lifted, np.zeros((3, 3)), self._forces)
        self._share_forces = Bound(share, self._sharing)
        self._swing_feet = Bound(swing, self._swinging)

    def step(self, state: State) -> Setpoints:
        """Return the efforts of all actuators of the robot."""
        sample = np.frombuffer(state.bodies[self._body], np.float64)
        if self._columns is None:
            self._find(state.bodies[self._body].dtype)
        assert self._columns is not None
        own = sample[self._columns]
        place, velocity, turning = own[:3], own[7:10], own[10:13]
        n = len(self._sheet.joints)
        angles, speeds, levers = own[13:13 + n], own[13 + n:13 + 2 * n], own[13 + 2 * n:]
        root = rotation(own[3:7])
        self._legs.update(root, turning, angles, speeds)
        seconds, self._t_ns = 1e-9 * (state.t_ns - self._t_ns), state.t_ns
        wanted, wants_steps = self._program.wanted(1e-9 * state.t_ns)
        if not self._is_begun:
            self._begin(place, root)
        was_standing = self._gait.is_standing
        self._turn(seconds * wanted[3])
        self._gait.advance(seconds, wants_steps)
        self._share(seconds, place, velocity, turning, root, wanted)
        self._swing(own, root, wanted, was_standing)
        torques = self._legs.holding[self._joints] + self._legs.torques(self._forces)
        efforts = np.minimum(np.maximum(torques / levers, self._least), self._most)
        return Setpoints(
            self._names, state.rows['position'][self._rows], effort=efforts, stiffness=0.0,
            damping=0.0)

    def _find(self, dtype: np.dtype[np.void]) -> None:
        """Find the numbers of the robot's sample that `step` reads."""
        joints = [joint.name for joint in self._sheet.joints]
        fields = ['position', 'orientation', 'velocity', 'angular_velocity',
                  *(f'{name}_position' for name in joints),
                  *(f'{name}_velocity' for name in joints),
                  *(f'{drive}_lever' for drive in self._drives)]
        places = np.arange(dtype.itemsize // 8, dtype=np.float64).view(dtype)[0]
        self._columns = np.concatenate(
            [np.atleast_1d(places[field]) for field in fields]).astype(np.int64)

    def _begin(self, place: np.ndarray, root: np.ndarray) -> None:
        """Take the stance of t = 0 as that of the robot at rest."""
        self._is_begun = True
        self._inertia = root.T @ self._legs.inertia(self._sheet) @ root
        self._heading = _heading(root)
        self._home = self._legs.feet[:, :2] @ level(self._heading)
        self._anchor = place[:2] + self._legs.com[:2]

    def _turn(self, angle: float) -> None:
        """Turn the heading that is wanted."""
        if angle == 0.0:
            return
        x, y = self._heading.tolist()
        c, s = cos(angle), sin(angle)
        self._heading[:] = c * x - s * y, s * x + c * y

    def _share(self, seconds: float, place: np.ndarray, velocity: np.ndarray, turning: np.ndarray,
               root: np.ndarray, wanted: np.ndarray) -> None:
        """Fill the forces of the standing feet: those on the ground, (f, 3)."""
        gains, legs, gait = self._gains, self._legs, self._gait
        height, turn_rate = wanted[0], wanted[3]
        com = legs.com
        of_com = velocity + cross(turning, com)
        ahead = level(self._heading)
        error = ahead @ wanted[1:3] - of_com[:2]
        wrench = self._sharing.wrench
        wrench[:2] = gains.speed_gain * error
        if gait.is_stepping:
            self._drag += gains.speed_integral * seconds * (error @ ahead)
            wrench[:2] += ahead @ self._drag
        else:
            self._drag[:] = 0.0
            wrench[:2] += gains.place_stiffness * (self._anchor - place[:2] - com[:2])
        wrench[2] = (STANDARD_GRAVITY + gains.height_stiffness * (height - place[2])
                     - gains.height_damping * velocity[2])
        wrench[:3] *= legs.mass
        tilt = attitude_error(root, self._heading)
        turning_error = turning.copy()
        turning_error[2] -= turn_rate
        wrench[3:] = root @ (self._inertia @ (root.T @ (
            -gains.tilt_stiffness * tilt - gains.tilt_damping * turning_error)))
        np.subtract(legs.feet, com, out=self._sharing.arms)
        self._sharing.is_standing[:] = gait.is_standing
        self._share_forces.run()

    def _swing(self, own: np.ndarray, root: np.ndarray, wanted: np.ndarray,
               was_standing: np.ndarray) -> None:
        """Fill the forces of the swinging feet."""
        gains, legs, gait = self._gains, self._legs, self._gait
        if gait.is_standing.all():
            return
        place, speed = own[:2], own[7:9]
        left_ground = was_standing & ~gait.is_standing
        if left_ground.any():
            self._lifted[left_ground] = own[:3] + legs.feet[left_ground]
        wanted_speed = level(self._heading) @ wanted[1:3]
        offset = (0.5 * gait.stand_s * wanted_speed + gains.capture * math.sqrt(
            wanted[0] / STANDARD_GRAVITY) * (speed - wanted_speed))
        swinging = self._swinging
        swinging.holds[:] = place + offset + self._home @ level(_heading(root)).T
        swinging.trunk[:3], swinging.trunk[3:] = own[:3], own[7:10]
        swinging.progress[:] = gait.progress
        self._swing_feet.run()

    def snapshot(self) -> bytes:
        """Return the whole state."""
        numbers = [float(self._is_begun), *self._gait.state(), *self._heading, *self._anchor,
                   *self._drag, *self._lifted.ravel(), *self._home.ravel(), *self._inertia.ravel()]
        return struct.pack(f'<q{len(numbers)}d', self._t_ns, *numbers)

    def restore(self, snapshot: bytes) -> None:
        """Continue from a `snapshot`."""
        n = len(self._legs.paths)
        self._t_ns, is_begun, *numbers = struct.unpack(f'<q{18 + 5 * n}d', snapshot)
        self._is_begun = bool(is_begun)
        self._gait.restore(numbers[:2])
        rest = np.array(numbers[2:])
        self._heading, self._anchor, self._drag = rest[:6].reshape(3, 2).copy()
        self._lifted[:] = rest[6:6 + 3 * n].reshape(n, 3)
        self._home = rest[6 + 3 * n:6 + 5 * n].reshape(n, 2).copy()
        self._inertia = rest[6 + 5 * n:].reshape(3, 3).copy()


def rotation(quaternion: np.ndarray) -> np.ndarray:
    """Return the rotation of a quaternion w, x, y, z, (3, 3)."""
    w, x, y, z = quaternion.tolist()
    return np.array([
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)]])


def _heading(root: np.ndarray) -> np.ndarray:
    """Return the direction of the trunk's x axis on the ground, (2,), of length 1."""
    x, y = float(root[0, 0]), float(root[1, 0])
    return np.array([x, y]) / math.sqrt(x * x + y * y)


def level(heading: np.ndarray) -> np.ndarray:
    """Return the rotation about the vertical to a heading of length 1, (2, 2)."""
    x, y = heading.tolist()
    return np.array([[x, -y], [y, x]])


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return a x b, (3,); ten times as fast as that of numpy."""
    a_x, a_y, a_z = a.tolist()
    b_x, b_y, b_z = b.tolist()
    return np.array([a_y * b_z - a_z * b_y, a_z * b_x - a_x * b_z, a_x * b_y - a_y * b_x])


def attitude_error(root: np.ndarray, heading: np.ndarray) -> np.ndarray:
    """
    Return the turn from level at a heading to ``root``, rad for small ones, (3,), world axes.

    Half the sum of d_k x r_k over the axes: the axis of the turn times the sine of its angle.
    """
    x, y = heading.tolist()
    (xx, yx, zx), (xy, yy, zy), (xz, yz, zz) = root.tolist()
    return 0.5 * np.array([
        y * xz + x * yz - zy,
        -x * xz + y * yz + zx,
        x * xy - y * xx - y * yy - x * yx])
