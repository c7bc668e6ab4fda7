"""A leg as the body of a run: its keys, its sheet, its actuators, its initial pose."""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import Any, ClassVar

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.models.catalogue import leg_section, material_section
from isa_ros.config.runs.tick_grid import ticks_in
from isa_ros.config.text.keys import (
    AnyValue, InText, Key, Layer, Name, Named, ParameterSet, Plain, Table)
from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.sections import Entry, merge, Place, Section, section_at, written
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.fields import Field
from isa_ros.core.noise import noise_key
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.leg.inertial import Imu
from isa_ros.surroundings.bodies.leg.leg import sample_fields, Unit
from isa_ros.surroundings.bodies.leg.messages import leg_messages
from isa_ros.surroundings.bodies.leg.sheet import JOINTS, LegSheet, linkage_record
from isa_ros.surroundings.linkage import actuator_coordinate
from isa_ros.surroundings.messages import BodyMessage


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

    kind: ClassVar[str] = 'leg'

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

    def units(self, step_ns: int, seed: int) -> list[Unit]:
        """Return the inertial units; ``seed`` is that of the run's noise."""
        return [Unit(imu.name, imu.sheet, imu.sheet.period_ns(step_ns, imu.name),
                     noise_key(seed, f'{imu.name}/imu')) for imu in self.imus]

    @property
    def fields(self) -> Sequence[Field]:
        """Return the fields of its sample."""
        return sample_fields([imu.name for imu in self.imus])

    def messages(self, step_ns: int) -> Sequence[BodyMessage]:
        """Return what is published of its sample."""
        return leg_messages(
            '/joint_states', '/coordinator/ground_contact', self.units(step_ns, seed=0))


class _ImuKind(Table):
    """The keys of a unit, in a resolved text below ``sheet``."""

    def read(self, tree: Any, place: Place) -> Any:
        """Return the unit; as `Kind.read`."""
        if 'sheet' in section_at(tree, place):
            return super().read(tree, place)['sheet']
        return self.keys[0].kind.read(tree, place)


_IMU = _ImuKind((Key('sheet', ParameterSet(Imu), 'the unit'),))

LEG = Table((
    Key('model', AnyValue('name'), 'the packaged leg', None, in_text=InText.ALWAYS),
    Key('joints', Table(tuple(
        Key(joint, Name(), f'the actuator that moves {joint}') for joint in JOINTS)),
        'the actuator of each joint', of=lambda leg: dict(leg.joints)),
    Key('ground', AnyValue('name'), 'the material under the foot', None, 'of the model',
        in_text=InText.NEVER),
    Key('start', ParameterSet(LegStart), 'pose at t = 0'),
    Key('imus', Named(_IMU), 'inertial measurement units', {}),
    Key('parameters', Layer(LegSheet), 'values that replace those of the model', {},
        in_text=InText.NEVER),
    Key('sheet', Layer(LegSheet), 'the whole sheet inline: of the model only the name is used',
        None, in_text=InText.ONLY)))


def leg_of(
        values: dict[str, Any], place: Place, step_ns: int,
        is_checked: bool) -> tuple[LegConfig, Section]:
    """
    Return a leg, and the section that its sheet was built from.

    ``values`` are those of `LEG`; ``is_checked`` as in `isa_ros.config.runs.actuator_config`.

    Raises
    ------
    ConfigError
        The model or the ground does not exist, or the start is beyond a joint's range.

    """
    name = values['model']
    if values['sheet'] is not None:
        Plain(str).read(name, place / 'model')
        section, section_place = values['sheet'], place / 'sheet'
    else:
        section, section_place = leg_section(name, f'{place}.model')
    if values['ground'] is not None:
        ground, _ = material_section(values['ground'], f'{place}.ground')
        section = merge(section, {'ground': ground})
    section = merge(section, values['parameters'])
    sheet = build(LegSheet, section, section_place)
    if is_checked:
        refuse_start(values['start'], sheet, step_ns, place / 'start')
        for own, imu in values['imus'].items():
            imu.period_ns(step_ns, str(place / 'imus' / own))
    return LegConfig(
        name, sheet, tuple(values['joints'].items()), values['start'],
        tuple(ImuConfig(own, imu) for own, imu in values['imus'].items())), section


def leg_start(tree: Tree, place: Place, base: LegStart) -> LegStart:
    """Return the start of a leg; keys missing in the section are as in ``base``."""
    default: Section = {f: Entry(getattr(base, f), str(place / f), '')
                        for f in LegStart.__dataclass_fields__}
    return build(LegStart, default | written(tree, place), place)


def refuse_start(start: LegStart, sheet: LegSheet, step_ns: int, place: Place) -> None:
    """Refuse joint angles outside the joints' ranges and a release between two ticks."""
    for joint in JOINTS:
        angle, limits = getattr(start, f'{joint}_deg'), getattr(sheet, joint)
        if not limits.low_deg <= angle <= limits.high_deg:
            raise ConfigError(
                f'{place}.{joint}_deg = {angle:g} deg, must be within its range '
                f'{limits.low_deg:g} to {limits.high_deg:g} deg')
    ticks_in(start.release_s, step_ns, f'{place}.release_s')


def refuse_reach(leg: LegConfig, joint: str, sheet: ActuatorSheet, where: str) -> None:
    """Refuse a start of the leg that is outside the stroke of a joint's actuator."""
    position, stroke = leg.position_of(joint), sheet.plant.drive.stroke
    if not 0.0 <= position <= stroke:
        scale, unit = (math.degrees(1.0), 'deg') if sheet.is_rotary else (1.0 / MILLI, 'mm')
        raise ConfigError(
            f'{where}: the start of the leg, {joint} = {math.degrees(leg.start.angle(joint)):g} '
            f'deg, puts it at {position * scale:.4g} {unit}, must be within its 0 to '
            f'{stroke * scale:.4g} {unit}')
