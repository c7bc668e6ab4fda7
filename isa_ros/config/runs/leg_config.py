"""A leg as the body of a run: its sheet, its actuators, its initial pose."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
import math
from typing import Any

from isa_ros.config.text.schema import KeyDifference, Plain
from isa_ros.config.text.sections import Place, refuse_unknown, section_at
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.leg.inertial import Imu
from isa_ros.surroundings.bodies.leg.sheet import JOINTS, LegSheet, linkage_record
from isa_ros.surroundings.linkage import actuator_coordinate


@dataclass(frozen=True, kw_only=True)
class LegStart(Parameters):
    """Pose of the leg at t = 0, and the time at which its slider is released."""

    haa_deg: float = parameter('hip abduction', 'deg', ge=-180.0, le=180.0)
    hfe_deg: float = parameter('hip flexion', 'deg', ge=-180.0, le=180.0)
    kfe_deg: float = parameter('knee flexion', 'deg', ge=-180.0, le=180.0)
    foot_height_mm: float = parameter('foot above the ground', 'mm', ge=-100.0, le=5000.0)
    release_s: float = parameter('slider held until then; 0: free', 's', ge=0.0, le=1e6)

    def angle(self, joint: str) -> float:
        """Return the angle of a joint of `JOINTS`, rad."""
        return math.radians(getattr(self, f'{joint}_deg'))


@dataclass(frozen=True)
class ImuConfig:
    """An inertial measurement unit of a leg."""

    name: str
    """Of its topic, ``/NAME/imu``."""
    sheet: Imu


@dataclass(frozen=True)
class LegConfig:
    """
    A leg as the body of a run.

    Its sheet, the actuator of each joint, its initial pose, and its inertial units.
    """

    model: str
    sheet: LegSheet
    joints: tuple[tuple[str, str], ...]
    """(joint, actuator) in the order of `JOINTS`."""
    start: LegStart
    imus: tuple[ImuConfig, ...] = ()

    def position_of(self, joint: str) -> float:
        """Return the position of a joint's actuator at the leg's start, m or rad  (L2)."""
        linkage = linkage_record(getattr(self.sheet, joint))
        return float(actuator_coordinate(self.start.angle(joint), linkage)[0])


class JointsKind:
    """Pairs of joint and actuator, in the order of `JOINTS`; a `Kind`."""

    def tree(self, value: Sequence[tuple[str, str]]) -> Tree:
        """Return the actuators by joint."""
        return dict(value)

    def read(self, tree: Any, place: Place) -> tuple[tuple[str, str], ...]:
        """Return (joint, actuator) of every joint; as `Kind.read`."""
        joints = section_at(tree, place)
        refuse_unknown(joints, JOINTS, place)
        for joint in JOINTS:
            if joint not in joints:
                raise ConfigError(place.has(f'lacks {joint}'))
        return tuple((joint, Plain(str).read(joints[joint], place / joint)) for joint in JOINTS)

    def differences(self, tree: Any, place: Place) -> Iterator[KeyDifference]:
        """Yield nothing: every leg has the same joints."""
        yield from ()
