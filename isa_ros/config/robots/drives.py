"""The drives of a robot in a run file: which actuator moves which joint, by which linkage."""

from collections.abc import Container, Mapping
import math
from typing import Any

from isa_ros.config.robots.frames import frame_named, in_link
from isa_ros.config.robots.like_linkages import linkage_section
from isa_ros.config.robots.patterns import sections_by_name
from isa_ros.config.robots.tree import RobotTree
from isa_ros.config.text.key_tables import KeyTable, NamedSections
from isa_ros.config.text.keys import FLAG, InText, Key, ParameterSet, PLACED_NAME, TEXT, Value
from isa_ros.config.text.names import refuse_bad_name
from isa_ros.config.text.parameter_sets import build_one_of, members
from isa_ros.config.text.sections import (
    KIND_KEYS, Place, Section, section_at, SourcedValue, written)
from isa_ros.config.text.yaml_text import Tree as YamlTree
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import check, numbers, parameter, Parameters
from isa_ros.core.suggest import alternatives
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.robot.sheet import (
    JointLinkage, Points, RobotDrive, RobotLink, vector)
from isa_ros.surroundings.linkage_sheet import Joint, linkage_record, OneJointLinkage

_OF_CYLINDER = ('base', 'rod', 'range', 'base_mm', 'rod_mm')
"""Keys that no other linkage has."""
_RANGE_DIGITS = 9       # of the range of a joint in deg: 1e-9 deg
_RANGE_ROUNDING = 1e-6  # deg or mm by which a range may exceed that of the URDF


@frozen(kw_only=True)
class CylinderBetweenLinks(Parameters):
    """A cylinder between a point of one link and a point of another one."""

    KIND = 'cylinder'
    base_mm: tuple[float, ...] = numbers(
        'pin of its cap end, axes of the link `base`', 'mm', least=3, most=3, ge=-1e5, le=1e5)
    rod_mm: tuple[float, ...] = numbers(
        'pin of its rod, axes of the link `rod`', 'mm', least=3, most=3, ge=-1e5, le=1e5)
    retracted_length_mm: float = parameter('pin to pin at piston 0', 'mm', gt=0.0, le=1e5)


Linkage = OneJointLinkage | CylinderBetweenLinks


@frozen(kw_only=True)
class DriveConfig:
    """A drive: a linkage of one joint, or a cylinder between two links."""

    name: str
    actuator: str
    linkage: Linkage
    joint: str | None = None
    """None of a cylinder."""
    base: str | None = None
    """Link of the URDF; None of a linkage of one joint."""
    rod: str | None = None
    joint_range: tuple[float, float] | None = None
    """deg or mm of the joint that a cylinder moves; None: that of the URDF."""


def _range(value: Any, place: Place, unit: str = 'deg | mm') -> tuple[float, float]:
    check(str(place), value, {'doc': 'lower and upper end', 'unit': unit,
                              'length': (2, 2), 'bounds': {'ge': -1e5, 'le': 1e5}})
    low, high = map(float, value)
    if not low < high:
        raise ConfigError(f'{place} = {value!r}, its first number must be < its second one')
    return low, high


DRIVE = KeyTable((
    Key('actuator', PLACED_NAME, 'the actuator', None, 'of its name'),
    Key('joint', TEXT, 'the joint of the URDF that its linkage drives', None, 'of its name'),
    Key('base', TEXT, "link of the pin of a cylinder's cap end", None,
        'required of a cylinder'),
    Key('rod', TEXT, 'link of the pin of its rod', None, 'required of a cylinder'),
    Key('range', Value('two numbers', _range, 'deg | mm'),
        'of the joint that a cylinder moves, within that of the URDF', None, 'that of the URDF',
        of=lambda own: own.joint_range),
    Key('like', TEXT, 'one of `linkages`, or LEG.JOINT of a packaged leg, whose values the drive '
        'has where it has none of its own', None, in_text=InText.NEVER),
    Key('mirrored', FLAG, 'whether the joint turns the other way than the one it is like', False,
        in_text=InText.NEVER)),
    rest=Key('linkage', ParameterSet(Linkage), 'its linkage'))


class Drives(NamedSections):
    """Drives by name, or by patterns of the joints they move, which `drives_of` resolves."""

    words = 'sections by name or pattern'

    def read(self, tree: Any, place: Place) -> Any:
        """Return the sections as they are; as `ValueKind.read`."""
        return section_at(tree, place)


def drives_of(
        given: YamlTree, linkages: Mapping[str, Section], tree: RobotTree,
        place: Place) -> tuple[tuple[DriveConfig, ...], dict[str, Section]]:
    """
    Return the drives of a file, and the section that each linkage was built from, by name.

    Those with the name of a joint are in the order of the joints, and before the others.

    ``linkages`` are those that ``like`` may name.

    Raises
    ------
    ConfigError
        A drive moves nothing, or lacks something.
    ParameterError
        A value is out of its range, or a linkage is not regular in the range of its joint.

    """
    joints = {link.joint.name: link for link in tree.links[1:]}
    drives, origins = [], {}
    sections = sections_by_name(given, list(joints), place)
    order = {name: k for k, name in enumerate(joints)}
    for name in sorted(sections, key=lambda name: order.get(name, len(order))):
        own, below = sections[name], place / name
        values = written(
            {key: value for key, value in own.items() if key not in DRIVE.names}, below)
        section = linkage_section(own, values, linkages, below)
        kind = next((entry.value for key in KIND_KEYS
                     if isinstance(entry := section.get(key), SourcedValue)), None)
        if kind is None:
            raise ConfigError(below.has(
                f'lacks linkage, one of {", ".join(members(Linkage))}, or like'))
        actuator = own.get('actuator', name)
        refuse_bad_name(actuator, str(below / 'actuator'), is_placed=True)
        if kind == 'cylinder':
            drive = _cylinder(name, str(actuator), own, section, tree, below)
        else:
            for key in _OF_CYLINDER:
                if key in own:
                    raise ConfigError(
                        f'{below / "linkage"} = {kind}, must be cylinder: {key} is not used '
                        'otherwise')
            joint = _joint_of(own, name, joints, sections, below)
            section = _with_range(section, joint, below)
            drive = DriveConfig(name=name, actuator=str(actuator), joint=joint.joint.name,
                                linkage=build_one_of(Linkage, section, below))
            _refuse_range(drive, joint, below)
        drives.append(drive)
        origins[name] = section
    return tuple(drives), origins


def _joint_of(
        own: YamlTree, name: str, joints: Mapping[str, RobotLink], drives: Container[str],
        place: Place) -> RobotLink:
    """Return the link whose joint a drive moves."""
    joint = own.get('joint', name)
    if not isinstance(joint, str) or joint not in joints:
        raise ConfigError(
            f'{place / "joint" if "joint" in own else place}: {joint!r} moves nothing: it is not '
            f'a joint of the URDF that turns or slides; {alternatives(str(joint), list(joints))}')
    if name in joints and joint != name and joint in drives:
        raise ConfigError(
            f'{place / "joint"} = {joint!r}, which the drive {joint} moves; {name} is a joint of '
            'its own, which nothing would move')
    if joints[joint].joint.kind == 'prismatic':
        raise ConfigError(
            f'{place}: the joint {joint} slides, its drive must be of the linkage cylinder, '
            'between two points')
    return joints[joint]


def _with_range(section: Section, link: RobotLink, place: Place) -> Section:
    """Return the values of a linkage with the range of the URDF where they have none."""
    joint, found = link.joint, dict(section)
    for key, end in (('low_deg', joint.low), ('high_deg', joint.high)):
        if key not in found:
            if not math.isfinite(end):
                raise ConfigError(place.has(
                    f'lacks low_deg and high_deg, the range of its linkage: the joint '
                    f'{joint.name} of the URDF is continuous'))
            found[key] = SourcedValue(
                round(math.degrees(end), _RANGE_DIGITS), str(place / key), 'the URDF')
    return found


def _refuse_range(drive: DriveConfig, link: RobotLink, place: Place) -> None:
    """Refuse a range that is wider than that of the joint."""
    assert isinstance(drive.linkage, Joint)
    low, high = drive.linkage.low_deg, drive.linkage.high_deg
    ends = [math.degrees(end) for end in (link.joint.low, link.joint.high)]
    if low < ends[0] - _RANGE_ROUNDING or high > ends[1] + _RANGE_ROUNDING:
        raise ConfigError(
            f'{place} has the range {low:g} to {high:g} deg, must be within that of the joint '
            f'{link.joint.name} in the URDF, {ends[0]:g} to {ends[1]:g} deg')


def _cylinder(
        name: str, actuator: str, own: YamlTree, section: Section, tree: RobotTree,
        place: Place) -> DriveConfig:
    """Return a cylinder between two links that move against each other."""
    if 'joint' in own:
        raise ConfigError(f'{place / "joint"} is not used: a cylinder moves all joints between '
                          'the links base and rod')
    for key in ('low_deg', 'high_deg'):
        if key in section:
            raise ConfigError(f'{place / key} is not used: the range of the joint that a cylinder '
                              'moves is the key range, two numbers')
    frames = {frame.name: frame for frame in tree.frames}
    ends = []
    for key in ('base', 'rod'):
        link = own.get(key)
        if not isinstance(link, str):
            raise ConfigError(place.has(f'lacks {key}, the link of a pin of the cylinder'))
        if link not in frames:
            raise ConfigError(f'{place / key} = {link!r} is not a link of the URDF; '
                              f'{alternatives(link, list(frames))}')
        ends.append(link)
    if frames[ends[0]].link == frames[ends[1]].link:
        raise ConfigError(
            f'{place} moves nothing: no joint that turns or slides is between its links base = '
            f'{ends[0]} and rod = {ends[1]}')
    return DriveConfig(
        name=name, actuator=actuator, linkage=build_one_of(Linkage, section, place),
        base=ends[0], rod=ends[1],
        joint_range=None if own.get('range') is None else _range(
            own['range'], place / 'range',
            _unit_between(tree, frames[ends[0]].link, frames[ends[1]].link)))


def _unit_between(tree: RobotTree, a: int, b: int) -> str:
    """Return the unit of the joint between two links of the tree, of several joints both units."""
    def path(link: int) -> set[int]:
        return set() if link <= 0 else {link, *path(tree.links[link].parent)}
    kinds = {tree.links[link].joint.kind for link in path(a) ^ path(b)}
    return 'mm' if kinds == {'prismatic'} else 'deg' if kinds == {'revolute'} else 'deg | mm'


def robot_drive(own: DriveConfig, tree: RobotTree) -> RobotDrive:
    """Return a drive of the sheet of a robot, SI."""
    if not isinstance(own.linkage, CylinderBetweenLinks):
        names = [link.joint.name for link in tree.links]
        assert own.joint is not None
        return RobotDrive(actuator=own.name, linkage=JointLinkage(
            link=names.index(own.joint), linkage=linkage_record(own.linkage)))
    (a, point_a), (b, point_b) = (
        in_link(frame_named(tree, link), [MILLI * one for one in place]) for link, place in (
            (own.base, own.linkage.base_mm), (own.rod, own.linkage.rod_mm)))
    return RobotDrive(actuator=own.name, linkage=Points(
        link_a=a, point_a=vector(point_a), link_b=b, point_b=vector(point_b),
        retracted_length=MILLI * own.linkage.retracted_length_mm))
