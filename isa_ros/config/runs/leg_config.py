"""A leg as the body of a run: its keys, its sheet, its actuators, its initial pose."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
import math
from pathlib import Path
from typing import Any, ClassVar

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.models.catalogue import leg_section, material_section
from isa_ros.config.runs.body_config import BODY, BodyConfig, BodyInputs
from isa_ros.config.runs.coarse_ticks import coarse_ticks
from isa_ros.config.runs.leg_description import DescribedLeg, urdf_of
from isa_ros.config.runs.tick_grid import ticks_in
from isa_ros.config.text.key_tables import KeyTable, NamedSections
from isa_ros.config.text.keys import (
    ANY_NAME, InText, Key, Layer, of_type, ParameterSet, PLACED_NAME)
from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.sections import merge, Place, Section, section_at, SourcedValue, written
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.fields import Field
from isa_ros.core.frozen import frozen
from isa_ros.core.noise import noise_key
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.leg.impact import foot_mass
from isa_ros.surroundings.bodies.leg.inertial import Imu
from isa_ros.surroundings.bodies.leg.leg import InertialUnit, Leg, LegPose, sample_fields
from isa_ros.surroundings.bodies.leg.messages import joint_name, leg_messages
from isa_ros.surroundings.bodies.leg.sheet import JOINTS, LegSheet
from isa_ros.surroundings.joint_space import DrivenJoint, JointSpace
from isa_ros.surroundings.linkage import actuator_coordinate
from isa_ros.surroundings.linkage_sheet import linkage_record
from isa_ros.surroundings.messages import BodyMessage


@frozen(kw_only=True)
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

    @property
    def angles(self) -> tuple[float, float, float]:
        """Return the angles in the order of `JOINTS`, rad."""
        haa, hfe, kfe = map(self.angle, JOINTS)
        return haa, hfe, kfe


@frozen
class ImuConfig:
    """An inertial measurement unit of a leg."""

    name: str
    """Of its topic, ``/NAME/imu``."""
    sheet: Imu


class _ImuKind(KeyTable):
    """The keys of a unit, in a resolved text below ``sheet``."""

    def read(self, tree: Any, place: Place) -> Any:
        """Return the unit; as `Kind.read`."""
        if 'sheet' in section_at(tree, place):
            return super().read(tree, place)['sheet']
        return self.keys[0].kind.read(tree, place)


_IMU = _ImuKind((Key('sheet', ParameterSet(Imu), 'the unit'),))


@frozen(kw_only=True)
class LegConfig(BodyConfig):
    """
    A leg as a body of a run.

    Its sheet, the actuator of each joint, its initial pose, and its inertial units.
    """

    kind: ClassVar[str] = 'leg'
    has_urdf: ClassVar[bool] = True
    KEYS: ClassVar[KeyTable] = KeyTable((
        Key('model', ANY_NAME, 'the packaged leg', None, 'required', InText.ALWAYS),
        Key('joints', KeyTable(tuple(
            Key(joint, PLACED_NAME, f'the actuator that moves {joint}') for joint in JOINTS)),
            'the actuator of each joint', of=lambda leg: dict(leg.joints)),
        Key('ground', ANY_NAME, 'the material under the foot', None, 'of the model',
            in_text=InText.NEVER),
        Key('start', ParameterSet(LegStart), 'pose at t = 0'),
        Key('imus', NamedSections(_IMU), 'inertial measurement units', {}),
        Key('parameters', Layer(LegSheet), 'values that replace those of the model', {},
            in_text=InText.NEVER),
        Key('sheet', Layer(LegSheet), 'the whole sheet inline: of the model only the name is used',
            None, in_text=InText.ONLY)))

    sheet: LegSheet
    start: LegStart
    imus: tuple[ImuConfig, ...] = ()

    @classmethod
    def of(cls, name: str, values: dict[str, Any], place: Place, step_ns: int,
           is_checked: bool) -> tuple[BodyConfig, Mapping[str, Section]]:
        """Return a leg, and the section that its sheet was built from; as `BodyConfig.of`."""
        model = values['model']
        if values['sheet'] is not None:
            of_type(model, str, place / 'model')
            section, section_place = values['sheet'], place / 'sheet'
        else:
            section, section_place = leg_section(model, f'{place}.model')
        if values['ground'] is not None:
            ground, _ = material_section(values['ground'], f'{place}.ground')
            section = merge(section, {'ground': ground})
        section = merge(section, values['parameters'])
        leg = cls(name=name, model=model, sheet=build(LegSheet, section, section_place),
                  joints=tuple(values['joints'].items()), start=values['start'],
                  imus=tuple(ImuConfig(own, imu) for own, imu in values['imus'].items()))
        if is_checked:
            leg.refuse_start(step_ns, place / 'start')
            for imu in leg.imus:
                imu.sheet.period_ns(step_ns, str(place / 'imus' / imu.name))
        return leg, {'sheet': section}

    @property
    def label(self) -> str:
        """Return ``leg``, the short form, if it is the body of the run."""
        return self.kind if self.name == BODY else f'bodies.{self.name}'

    @cached_property
    def joint_space(self) -> JointSpace:
        """Return HAA, HFE and KFE."""
        found = {}
        for joint, actuator in self.joints:
            sheet = getattr(self.sheet, joint)
            found[joint_name(joint)] = DrivenJoint(
                actuator, linkage_record(sheet), math.radians(sheet.low_deg),
                math.radians(sheet.high_deg), 'position', JOINTS.index(joint))
        return found

    def position_of(self, joint: str) -> float:
        """Return the position of a joint's actuator at the leg's start, m or rad  (L2)."""
        linkage = linkage_record(getattr(self.sheet, joint))
        return float(actuator_coordinate(self.start.angle(joint), linkage)[0])

    def refuse_reach(self, joint: str, sheet: ActuatorSheet, where: str) -> None:
        """Refuse a start of the leg that is outside the stroke of a joint's actuator."""
        position, stroke = self.position_of(joint), sheet.plant.drive.stroke
        if not 0.0 <= position <= stroke:
            scale, unit = (math.degrees(1.0), 'deg') if sheet.is_rotary else (1.0 / MILLI, 'mm')
            raise ConfigError(
                f'{where}: the start of {self.called}, {joint} = '
                f'{math.degrees(self.start.angle(joint)):g} deg, puts it at '
                f'{position * scale:.4g} {unit}, must be within its 0 to '
                f'{stroke * scale:.4g} {unit}')

    def refuse_start(self, step_ns: int, place: Place) -> None:
        """Refuse joint angles outside the joints' ranges and a release between two ticks."""
        for joint in JOINTS:
            angle, limits = getattr(self.start, f'{joint}_deg'), getattr(self.sheet, joint)
            if not limits.low_deg <= angle <= limits.high_deg:
                raise ConfigError(
                    f'{place}.{joint}_deg = {angle:g} deg, must be within its range '
                    f'{limits.low_deg:g} to {limits.high_deg:g} deg')
        ticks_in(self.start.release_s, step_ns, f'{place}.release_s')

    def started(self, tree: Tree, place: Place, step_ns: int) -> 'LegConfig':
        """Return it with another start; keys missing in the section are as before."""
        default: Section = {f: SourcedValue(getattr(self.start, f), str(place / f), '')
                            for f in LegStart.__dataclass_fields__}
        leg = replace(self, start=build(LegStart, default | written(tree, place), place))
        leg.refuse_start(step_ns, place)
        return leg

    def description(self, sheets: Mapping[str, ActuatorSheet], folder: Path,
                    control: Iterable[str] = ()) -> str:
        """Return its URDF, which is made from its sheet; as `BodyConfig.description`."""
        own = DescribedLeg(self.model, self.prefix, self.sheet, self.joints,
                           [(imu.name, imu.sheet) for imu in self.imus])
        return urdf_of(own, sheets, control)

    def warnings(self, step_ns: int) -> Sequence[str]:
        """Return a line if the ticks are too long for the ground."""
        return coarse_ticks(self.called, foot_mass(self.sheet, self.start.angles),
                            self.sheet.ground.stiffness, step_ns)

    @property
    def fields(self) -> Sequence[Field]:
        """Return the fields of its sample."""
        return sample_fields([imu.name for imu in self.imus])

    def messages(self, step_ns: int) -> Sequence[BodyMessage]:
        """Return joints, contact of the foot, and readings of its inertial units."""
        return leg_messages(self.prefix, self._units(step_ns, seed=0))

    def body(self, made: BodyInputs) -> Leg:
        """Return the leg; as `BodyConfig.body`."""
        pose = LegPose(**{joint: self.start.angle(joint) for joint in JOINTS},
                       foot_height=self.start.foot_height_mm * MILLI)
        return Leg(self.sheet, pose, made.step_ns, made.rows,
                   release_ns=round(self.start.release_s * NS_PER_SECOND),
                   units=self._units(made.step_ns, made.seed))

    def _units(self, step_ns: int, seed: int) -> list[InertialUnit]:
        return [InertialUnit(imu.name, imu.sheet, imu.sheet.period_ns(step_ns, imu.name),
                             noise_key(seed, f'{self.prefix}{imu.name}/imu')) for imu in self.imus]
