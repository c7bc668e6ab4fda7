"""A robot as the body of a run: the tree of a URDF, and a table of what moves and touches it."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
import math
from pathlib import Path
from typing import Any, ClassVar

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.config.robots.contacts import (
    CONTACT, ContactConfig, Contacts, contacts_of, GROUND, robot_contact)
from isa_ros.config.robots.drives import DRIVE, DriveConfig, Drives, drives_of, robot_drive
from isa_ros.config.robots.geometry import motion_of
from isa_ros.config.robots.impact import contact_masses
from isa_ros.config.robots.patterns import names_in
from isa_ros.config.robots.reach import reach_of, refuse_lever, refuse_stroke
from isa_ros.config.robots.start import (
    coordinates, refuse_start, robot_start, RobotStartConfig, root_pose, START, start_of)
from isa_ros.config.robots.tree import RobotTree, tree_of_file
from isa_ros.config.robots.tree_text import TREE, tree_from
from isa_ros.config.robots.units import errors_of, refuse_units, robot_unit, UNIT, UnitConfig
from isa_ros.config.runs.body_config import BodyConfig, BodyInputs
from isa_ros.config.runs.coarse_ticks import coarse_ticks
from isa_ros.config.runs.robot_description import description_of
from isa_ros.config.runs.tick_grid import ticks_in
from isa_ros.config.text.key_tables import KeyTable, NamedSections
from isa_ros.config.text.keys import choice_of, InText, Key, Layer, TEXT, Value
from isa_ros.config.text.sections import names_at, Place, Section
from isa_ros.config.text.yaml_text import Tree as YamlTree
from isa_ros.core.fields import Field
from isa_ros.core.frozen import frozen
from isa_ros.core.noise import noise_key
from isa_ros.core.parameter import Parameters
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.robot.messages import robot_messages
from isa_ros.surroundings.bodies.robot.robot import Robot
from isa_ros.surroundings.bodies.robot.sample import sample_fields
from isa_ros.surroundings.bodies.robot.sheet import (
    JointLinkage, matrix, MovingPart, RobotDrive, RobotSheet, RobotUnit, vector)
from isa_ros.surroundings.bodies.robot.unit_errors import changing_values
from isa_ros.surroundings.impact import contact_time
from isa_ros.surroundings.joint_space import DrivenJoint, JointSpace
from isa_ros.surroundings.linkage_sheet import Direct, Joint
from isa_ros.surroundings.messages import BodyMessage

FREE, FIXED = 'free', 'fixed'


@frozen(kw_only=True)
class RobotConfig(BodyConfig):
    """
    A robot as a body of a run.

    The tree of its URDF, its drives, the points that touch the ground, its start and its inertial
    units.
    """

    kind: ClassVar[str] = 'robot'
    has_urdf: ClassVar[bool] = True
    KEYS: ClassVar[KeyTable] = KeyTable((
        Key('urdf', TEXT, 'a file beside the run file, or a shipped one', in_text=InText.ALWAYS),
        Key('root', choice_of((FREE, FIXED)), 'whether its root moves', FIXED,
            of=lambda own: own.tree.links[0].joint.kind),
        Key('linkages', NamedSections(Layer(Joint)), 'linkages that drives may be `like`', {},
            in_text=InText.NEVER),
        Key('drives', Drives(DRIVE), 'what each actuator moves', in_text=InText.ALWAYS),
        Key('passive', Value('list of names or patterns', lambda value, place: tuple(
            names_at(value, place))), 'joints without an actuator', [],
            of=lambda own: own.passive),
        Key('ground', GROUND, 'material under the contacts', None, in_text=InText.NEVER),
        Key('contacts', Contacts(CONTACT), 'points that touch the ground', {}),
        Key('start', START, 'pose at t = 0', {}),
        Key('imus', NamedSections(UNIT), 'inertial measurement units', {}),
        Key('tree', TREE, 'links and frames inline: of the URDF only the name is used', None,
            in_text=InText.ONLY)))

    urdf: str
    """Its name."""
    tree: RobotTree
    drives: tuple[DriveConfig, ...]
    passive: tuple[str, ...]
    """Joints without a drive."""
    contacts: tuple[ContactConfig, ...]
    start: RobotStartConfig
    imus: tuple[UnitConfig, ...] = ()

    def __post_init__(self) -> None:
        """Give the drives the actuators of ``joints``, which a namespace renames."""
        moved = dict(self.joints)
        object.__setattr__(self, 'drives', tuple(
            replace(own, actuator=moved[own.name]) for own in self.drives))

    @classmethod
    def of(cls, name: str, values: dict[str, Any], place: Place, step_ns: int,
           is_checked: bool) -> tuple[BodyConfig, Mapping[str, Section]]:
        """Return a robot, and the sections of its drives; as `BodyConfig.of`."""
        tree = tree_from(values['tree']) if values['tree'] is not None else tree_of_file(
            values['urdf'], values['root'] == FREE, place)
        drives, origins = drives_of(values['drives'], values['linkages'], tree, place / 'drives')
        joints = [link.joint.name for link in tree.links[1:]]
        passive = names_in(values['passive'], joints, place / 'passive')
        contacts = contacts_of(values['contacts'], values['ground'], tree, place / 'contacts')
        robot = cls(
            name=name, urdf=Path(values['urdf']).name, tree=tree, drives=drives,
            joints=tuple((own.name, own.actuator) for own in drives), passive=tuple(passive),
            contacts=contacts, start=start_of(values['start'], tree, None, place / 'start'),
            imus=tuple(UnitConfig(own, unit['link'], unit['sheet'], bool(unit['can_fail']))
                       for own, unit in values['imus'].items()))
        refuse_units(robot.imus, tree, step_ns, place / 'imus')
        if is_checked:
            robot._refuse_joints(place)
            robot._refuse_start(step_ns, place / 'start')
            for drive, own in zip(robot.sheet.drives, drives):
                refuse_lever(
                    robot.sheet, drive, own, robot.coordinates, place / 'drives' / own.name)
        return robot, {f'drives.{own}': section for own, section in origins.items()}

    def key_of(self, joint: str) -> str:
        """Return the key of a drive."""
        return f'{self.label}.drives.{joint}.actuator'

    @cached_property
    def sheet(self) -> RobotSheet:
        """Return the sheet of the robot, SI; a fixed root is where the start has it."""
        drives = tuple(robot_drive(own, self.tree) for own in self.drives)
        contacts = tuple(robot_contact(own, self.tree) for own in self.contacts)
        root = self.tree.links[0]
        if root.joint.kind == FIXED:
            at = root_pose(self.start, self.tree, contacts)
            root = replace(root, joint=replace(
                root.joint, place=vector(at.place.tolist()), rotation=matrix(
                    at.rotation.tolist())))
        return RobotSheet(links=(root, *self.tree.links[1:]), drives=drives, contacts=contacts,
                          frames=self.tree.frames)

    @cached_property
    def coordinates(self) -> tuple[float, ...]:
        """Return the coordinates of the joints at the start, rad or m, (n,)."""
        return coordinates(self.start, self.tree)

    def _drive(self, name: str) -> int:
        return [own.name for own in self.drives].index(name)

    def position_of(self, joint: str) -> float:
        """Return the position of a drive's actuator at the start, m or rad."""
        return motion_of(
            self.sheet, self.sheet.drives[self._drive(joint)], self.coordinates)[0]

    def refuse_reach(self, joint: str, sheet: ActuatorSheet, where: str) -> None:
        """Refuse an actuator whose stroke does not cover the start, or the range of its joint."""
        k = self._drive(joint)
        own, drive = self.drives[k], self.sheet.drives[k]
        place = Place(where.partition(': ')[0], f'{self.label}.drives.{own.name}')
        if isinstance(own.linkage, Direct) != sheet.is_rotary:
            kind = 'rotary' if sheet.is_rotary else 'linear'
            raise ConfigError(
                f'{place}: its actuator {own.actuator} is {kind}, must be of a linkage '
                f'{"direct" if sheet.is_rotary else "slider_crank, four_bar or cylinder"}')
        position, stroke = self.position_of(joint), sheet.plant.drive.stroke
        if not 0.0 <= position <= stroke:
            scale, unit = (math.radians(1.0), 'deg') if sheet.is_rotary else (MILLI, 'mm')
            raise ConfigError(
                f'{where}: the start of {self.called} puts it at {position / scale:.4g} {unit}, '
                f'must be within its stroke, 0 to {stroke / scale:.4g} {unit}: {_length(own)}')
        reach = reach_of(self.sheet, drive, own, self.coordinates, place)
        if reach is not None:
            refuse_stroke(reach, stroke, sheet.is_rotary, str(place))

    def _refuse_joints(self, place: Place) -> None:
        """Refuse a joint that neither moves by an actuator nor is declared passive."""
        driven = {self.tree.links[link].joint.name: own.actuator for own in self.sheet.drives
                  for link in self.sheet.driven(own)}
        for link in self.tree.links[1:]:
            joint = link.joint.name
            if joint in driven and joint in self.passive:
                raise ConfigError(f'{place / "passive"} has {joint}, which {driven[joint]} moves')
            if joint not in driven and joint not in self.passive:
                raise ConfigError(
                    f'{place}: no actuator moves the joint {joint}: give it a drive, or name it '
                    'in passive')

    def _refuse_start(self, step_ns: int, place: Place) -> None:
        refuse_start(self.start, self.tree, self.sheet.contacts, place)
        ticks_in(self.start.root.release_s, step_ns, f'{place}.release_s')

    def started(self, tree: YamlTree, place: Place, step_ns: int) -> 'RobotConfig':
        """Return it with another start; keys missing in the section are as before."""
        before = START.rest.kind.tree(self.start.root) if START.rest is not None else {}
        values = START.read({**before, **tree}, place)
        robot = replace(self, start=start_of(values, self.tree, self.start, place))
        robot._refuse_start(step_ns, place)
        return robot

    @property
    def fields(self) -> Sequence[Field]:
        """Return the fields of its sample."""
        return sample_fields(self.sheet, [own.name for own in self.imus])

    def warnings(self, step_ns: int) -> Sequence[str]:
        """Return a line if the ticks are too long for the ground under one of its contacts."""
        sheet = self.sheet
        root = root_pose(self.start, self.tree, sheet.contacts)
        masses = contact_masses(sheet, self.coordinates, root)
        found = [(contact_time(mass, contact.ground.stiffness), mass, contact)
                 for mass, contact in zip(masses, sheet.contacts) if math.isfinite(mass)]
        if not found:
            return ()
        _, mass, contact = min(found, key=lambda one: one[0])
        return coarse_ticks(
            f'{contact.name} of {self.called}', mass, contact.ground.stiffness, step_ns)

    @property
    def changing(self) -> Parameters | None:
        """Return what scenarios may change: forces on a free root, errors of its units."""
        errors = {own.name: errors_of(own) for own in self.imus}
        return changing_values(self.sheet.is_free, {
            name: own for name, own in errors.items() if own is not None})

    def units(self, step_ns: int, seed: int) -> list[RobotUnit]:
        """Return its inertial units."""
        return [
            robot_unit(
                own, self.tree, step_ns, noise_key(seed, f'{self.prefix}{own.name}/imu'))
            for own in self.imus]

    @cached_property
    def joint_space(self) -> JointSpace:
        """Return the joints that one actuator moves which moves no other, as those of the URDF."""
        drives = [(drive, own, self.sheet.driven(drive))
                  for drive, own in zip(self.sheet.drives, self.drives)]
        moved = Counter(link for _, _, links in drives for link in links)
        found = {}
        for drive, own, links in drives:
            joint = self.tree.links[links[0]].joint
            if len(links) == 1 and moved[links[0]] == 1:
                found[joint.name] = DrivenJoint(
                    own.actuator, drive.linkage.linkage if isinstance(
                        drive.linkage, JointLinkage) else self._at(drive, links[0]),
                    joint.low, joint.high, f'{joint.name}_position',
                    unit='rad' if joint.kind == 'revolute' else 'm')
        order = [link.joint.name for link in self.tree.links]
        return dict(sorted(found.items(), key=lambda item: order.index(item[0])))

    def _at(self, drive: RobotDrive, link: int) -> Callable[[float], tuple[float, float]]:
        """Return what gives coordinate and lever of a cylinder over one joint."""
        def at(angle: float) -> tuple[float, float]:
            joints = [0.0] * len(self.sheet.joints)
            joints[link - 1] = angle
            x, levers = motion_of(self.sheet, drive, joints)
            return x, levers[0]
        return at

    @property
    def root_frame(self) -> str:
        """Return the frame of its root, which may move."""
        return f'{self.prefix}{self.tree.links[0].name}'

    def description(self, sheets: Mapping[str, ActuatorSheet], folder: Path,
                    control: Iterable[str] = ()) -> str:
        """Return the URDF of its file; as `BodyConfig.description`."""
        return description_of(self.urdf, self.prefix, self.drives, folder, control)

    def messages(self, step_ns: int) -> Sequence[BodyMessage]:
        """Return joints, pose of a free root, forces on the feet, readings of its units."""
        return robot_messages(self.prefix, self.sheet, list(zip(
            self.units(step_ns, seed=0), [own.link for own in self.imus])))

    def body(self, made: BodyInputs) -> Robot:
        """Return the robot; as `BodyConfig.body`."""
        start = robot_start(self.start, self.tree, self.sheet.contacts, self.passive)
        mechanics = [actuator.sheet.plant.mechanics for actuator in made.actuators]
        return Robot(
            self.sheet, start, made.step_ns, made.rows,
            release_ns=round(self.start.root.release_s * NS_PER_SECOND),
            units=self.units(made.step_ns, made.seed),
            moving=[MovingPart(own.inertia, own.sensor_stiffness) for own in mechanics])


def _length(own: DriveConfig) -> str:
    """Return what of a drive decides where its actuator starts."""
    if isinstance(own.linkage, Direct):
        return f'its offset_deg = {own.linkage.offset_deg:g} deg'
    return f'its retracted_length_mm = {own.linkage.retracted_length_mm:g} mm'
