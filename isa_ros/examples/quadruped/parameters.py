"""Numbers of the trot: how the trunk is held, how feet step, and what is wanted over time."""

from collections.abc import Mapping, Sequence
from typing import Any

from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.sections import Place, section_at, written
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.errors import ConfigError
import numpy as np

PROGRAM = 'program'
"""Key of the list of points."""


@frozen(kw_only=True)
class TrotGains(Parameters):
    """Parameters of `Trot`; those of a law are per unit of mass or inertia of the robot."""

    frequency: float = parameter('strides a second of a foot', 'Hz', absent=1.7, ge=0.5, le=4.0)
    duty: float = parameter(
        'part of a stride in which a foot stands', '1', absent=0.55, ge=0.5, le=0.9)
    lift: float = parameter(
        'of a foot in the middle of its swing', 'm', absent=0.08, ge=0.0, le=0.3)
    press: float = parameter(
        'depth below the ground at which a swing ends', 'm', absent=0.004, ge=0.0, le=0.05)
    capture: float = parameter(
        'foothold per error of the speed, in parts of sqrt(height/g)', '1',
        absent=0.5, ge=0.0, le=2.0)
    height_stiffness: float = parameter('of the height', '1/s2', absent=80.0, ge=0.0, le=1e3)
    height_damping: float = parameter('of the height', '1/s', absent=14.0, ge=0.0, le=100.0)
    place_stiffness: float = parameter(
        'of the centre of mass while all feet stand', '1/s2', absent=10.0, ge=0.0, le=1e3)
    speed_gain: float = parameter('of the centre of mass', '1/s', absent=4.0, ge=0.0, le=100.0)
    speed_integral: float = parameter(
        'of its error: actuators and legs brake in proportion to the speed', '1/s2',
        absent=3.0, ge=0.0, le=100.0)
    tilt_stiffness: float = parameter('of the attitude', '1/s2', absent=120.0, ge=0.0, le=1e3)
    tilt_damping: float = parameter('of the attitude', '1/s', absent=18.0, ge=0.0, le=100.0)
    swing_stiffness: float = parameter('of a swinging foot', 'N/m', absent=1500.0, ge=0.0, le=1e5)
    swing_damping: float = parameter('of a swinging foot', 'N s/m', absent=60.0, ge=0.0, le=1e4)
    least_force: float = parameter('of a standing foot', 'N', absent=10.0, ge=0.0, le=1e4)
    most_force: float = parameter('of a standing foot', 'N', absent=1500.0, gt=0.0, le=1e5)
    friction: float = parameter(
        'that the forces of standing feet use', '1', absent=0.6, gt=0.0, le=5.0)


@frozen(kw_only=True)
class Point(Parameters):
    """What is wanted at one time; between two points it changes evenly."""

    t_s: float = parameter('time since t = 0', 's', ge=0.0, le=1e6)
    height: float = parameter("of the trunk's origin above the ground", 'm', ge=0.1, le=2.0)
    speed: float = parameter('forward', 'm/s', absent=0.0, ge=-3.0, le=3.0)
    side_speed: float = parameter('to the left', 'm/s', absent=0.0, ge=-2.0, le=2.0)
    turn_rate: float = parameter('to the left', 'rad/s', absent=0.0, ge=-2.0, le=2.0)
    steps: float = parameter(
        '1: trot, 0: stand, from this point on', '1', is_whole=True, absent=0.0, ge=0.0, le=1.0)


class TrotProgram:
    """What is wanted over time, from a list of points; values of before hold where it has none."""

    def __init__(self, points: Sequence[Point]) -> None:
        self.times = [point.t_s for point in points]
        self._rows = np.array([
            [point.height, point.speed, point.side_speed, point.turn_rate] for point in points])
        self._steps = [point.steps > 0.0 for point in points]
        self._at = 0

    def wanted(self, t: float) -> tuple[np.ndarray, bool]:
        """Return height, m, speeds, m/s, and turn rate, rad/s, (4,), and whether to step."""
        k = self._at if self.times[self._at] <= t else 0
        while k + 1 < len(self.times) and self.times[k + 1] <= t:
            k += 1
        self._at = k
        if k + 1 == len(self.times):
            return self._rows[k], self._steps[k]
        part = (t - self.times[k]) / (self.times[k + 1] - self.times[k])
        return self._rows[k] + part * (self._rows[k + 1] - self._rows[k]), self._steps[k]


def program_of(trees: Any, place: Place) -> TrotProgram:
    """
    Return the program of a list of points; a point has what differs from the one before.

    Raises
    ------
    ConfigError
        It is not a list, a point is refused, or the times do not start at 0 and rise.

    """
    if not isinstance(trees, list) or not trees:
        raise ConfigError(f'{place} = {trees!r}, must be a list of points')
    points: list[Point] = []
    so_far: Tree = {}
    for k, tree in enumerate(trees):
        below = Place(place.file, f'{place.key}[{k}]')
        so_far = {**so_far, **section_at(tree, below)}
        point = build(Point, written(so_far, below), below)
        if point.t_s <= points[-1].t_s if points else point.t_s != 0.0:
            raise ConfigError(
                f'{below}.t_s = {point.t_s:g} s, must be '
                + (f'> {points[-1].t_s:g} s, that of the point before' if points else '0 s'))
        points.append(point)
    return TrotProgram(points)


def gains_of(tree: Mapping[str, Any], place: Place) -> TrotGains:
    """Return the gains of a section; raises `ConfigError` where one is refused."""
    return build(TrotGains, written(dict(tree), place), place)
