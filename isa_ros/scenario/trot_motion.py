"""
A trot as the motion of one actuator: the joint it moves, through its linkage.

At a joint of the leg the actuator moves smoothly from its setpoint's position to that of the
trot. On its own load it moves about its setpoint's position: a rotary actuator as if it were on
the joint itself, a linear one through the linkage of the joint. Equations G1 to G7.
"""

from dataclasses import field, fields
from functools import cached_property
import math

from isa_ros.config.models.catalogue import gait_section, leg_section
from isa_ros.config.runs.leg_config import LegConfig
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.config.text.parameter_sets import as_tree, build
from isa_ros.config.text.sections import merge, Place, written
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import choice, parameter
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError
from isa_ros.scenario.trot import (
    CHECKED_INSTANTS, smooth_step, TrotParameters, trotting_leg, TrottingLeg)
from isa_ros.scenario.waveforms import Excursion
from isa_ros.surroundings.bodies.leg.sheet import JOINTS, LegSheet
from isa_ros.surroundings.linkage import actuator_coordinate
from isa_ros.surroundings.linkage_sheet import Direct, linkage_record
import numpy as np

LEG = 'hyq_real'  # leg of the trot in a run without one
GAIT = 'trot'
_STARTING_STRIDES = 10     # at most, as which the start is sampled


@frozen(kw_only=True)
class GaitParameters(TrotParameters):
    """A trot, and the part of it that one actuator follows."""

    joint: str = choice('the joint it moves', *JOINTS)
    phase: float = parameter('stride phase at its start; 0: touch-down', '1', ge=0.0, le=1.0)
    start_s: float = parameter('time to grow from standing to the whole motion', 's',
                               ge=0.0, le=100.0)
    feed_forward: float = parameter(
        'part of the torque of the joint that is added to the effort', '1', ge=0.0, le=1.0)


@frozen
class GaitMotion:
    """A trot in the coordinate of one actuator."""

    gait: GaitParameters
    sheet: LegSheet
    is_direct: bool
    """The coordinate is the joint's angle itself, whatever the joint's linkage."""
    rest: float | None
    """Position of the actuator before, m or rad; None: the middle of the motion."""
    _leg: TrottingLeg = field(init=False, repr=False, compare=False)
    _linkage: np.void = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Prepare the leg; raises as `TrottingLeg`."""
        trot = TrotParameters(
            **{f.name: getattr(self.gait, f.name) for f in fields(TrotParameters)})
        object.__setattr__(self, '_leg', trotting_leg(trot, self.sheet))
        object.__setattr__(self, '_linkage', linkage_record(getattr(self.sheet, self.gait.joint)))

    def _joint(self, stride: float) -> tuple[float, float, float]:
        """Return position, velocity and effort of the actuator at a time in strides  (L2)."""
        joints, k = self._leg.at(stride), JOINTS.index(self.gait.joint)
        angle, speed, torque = joints.angle[k], joints.speed[k], joints.torque[k]
        if self.is_direct:
            return angle, speed, torque
        x, lever, _ = actuator_coordinate(angle, self._linkage)
        return x, lever * speed, torque / lever

    @cached_property
    def span(self) -> tuple[float, float]:
        """Return the least and the greatest position of a stride, m or rad."""
        positions = [position for position, _, _ in self._stride]
        return min(positions), max(positions)

    @cached_property
    def _stride(self) -> list[tuple[float, float, float]]:
        """Return position, velocity and effort of the actuator at the instants of a stride."""
        return [self._joint(k / CHECKED_INSTANTS) for k in range(CHECKED_INSTANTS)]

    def reach(self) -> tuple[Excursion, Excursion]:
        """Return the least and the greatest excursion, those of the start with them."""
        low, high = (end - self.origin for end in self.span)
        efforts = [0.0, *(self.gait.feed_forward * effort for _, _, effort in self._stride)]
        speeds = [speed for _, speed, _ in self._stride] + self._starting_speeds
        return (Excursion(min(low, 0.0), min(speeds), min(efforts)),
                Excursion(max(high, 0.0), max(speeds), max(efforts)))

    @property
    def _starting_speeds(self) -> list[float]:
        """Return the velocity of the actuator at instants of the start, as many as of strides."""
        strides = self.gait.start_s * self.gait.step_frequency_hz
        n = math.ceil(CHECKED_INSTANTS * min(max(1.0, strides), _STARTING_STRIDES))
        return [self.at(round(k / n * self.gait.start_s * NS_PER_SECOND)).velocity
                for k in range(n)]

    @cached_property
    def origin(self) -> float:
        """Return the position from which excursions are measured, m or rad."""
        low, high = self.span
        return 0.5 * (low + high) if self.rest is None else self.rest

    def at(self, t_ns: int) -> Excursion:
        """
        Return the excursion: the gait's own, grown by w(t/T) while t < T = start_s  (G7).

        x = w (x_g - x_0), v = w v_g + w' (x_g - x_0), F = w F_g.
        """
        t = t_ns / NS_PER_SECOND
        position, velocity, effort = self._joint(
            self.gait.phase + t * self.gait.step_frequency_hz)
        away, effort = position - self.origin, self.gait.feed_forward * effort
        if t >= self.gait.start_s:
            return Excursion(away, velocity, effort)
        w, slope, _ = smooth_step(t / self.gait.start_s)
        return Excursion(w * away, w * velocity + slope / self.gait.start_s * away, w * effort)

    def tree(self) -> Tree:
        """Return its section of a scenario file."""
        return as_tree(self.gait)


def read_gait(tree: Tree, place: Place, actuator: ActuatorConfig, leg: LegConfig | None,
              setpoint: float) -> GaitMotion:
    """
    Return the gait of a section; ``setpoint`` is its setpoint's position, m or rad.

    Missing keys are as in the packaged trot.

    Raises
    ------
    ConfigError
        The section is invalid, or the leg or the actuator cannot follow the trot.

    """
    gait = build(
        GaitParameters, merge(gait_section(GAIT, str(place)), written(tree, place)), place)
    joint_of = {name: joint for joint, name in leg.joints} if leg else {}
    moved = joint_of.get(actuator.name)
    is_direct = moved is None and actuator.sheet.is_rotary
    if leg is None or moved is None:
        sheet = build(LegSheet, *leg_section(LEG, str(place)))
        if not is_direct and isinstance(getattr(sheet, gait.joint), Direct):
            raise ConfigError(
                f'{place}.joint = {gait.joint!r} has no linkage for the linear {actuator.name}')
    elif moved == gait.joint:
        sheet = leg.sheet
    else:
        raise ConfigError(f'{place}.joint = {gait.joint!r}, must be {moved}: {actuator.name} '
                          'moves it')
    try:
        motion = GaitMotion(gait, sheet, is_direct, None if moved is None else setpoint)
    except ConfigError as error:
        raise ConfigError(f'{place}: {error}') from error
    _refuse_stroke(motion, actuator, setpoint, place)
    return motion


def _refuse_stroke(
        motion: GaitMotion, actuator: ActuatorConfig, setpoint: float, place: Place) -> None:
    low, high = (setpoint + end - motion.origin for end in motion.span)
    stroke = actuator.sheet.plant.drive.stroke
    if not (0.0 <= low and high <= stroke):
        unit = 'rad' if actuator.sheet.is_rotary else 'm'
        raise ConfigError(
            f'{place} moves {actuator.name} from {low:.4g} to {high:.4g} {unit}, must stay '
            f'within its 0 to {stroke:.4g} {unit}')
