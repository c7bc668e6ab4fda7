"""The points of a robot that touch the ground, in a run file."""

from collections.abc import Mapping
from typing import Any

from isa_ros.config.models.catalogue import material_section
from isa_ros.config.robots.frames import frame_named, in_link
from isa_ros.config.robots.patterns import sections_by_name
from isa_ros.config.robots.tree import RobotTree
from isa_ros.config.text.key_tables import KeyTable, NamedSections
from isa_ros.config.text.keys import FLAG, Key, ParameterSet, TEXT, Value
from isa_ros.config.text.parameter_sets import build
from isa_ros.config.text.sections import Place, section_at
from isa_ros.config.text.yaml_text import Tree as YamlTree
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import check
from isa_ros.core.suggest import alternatives
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.robot.sheet import RobotContact, vector
from isa_ros.surroundings.ground import Ground


@frozen(kw_only=True)
class ContactConfig:
    """A point of a link that touches the ground."""

    name: str
    link: str
    """Of the URDF."""
    at_mm: tuple[float, float, float]
    ground: Ground
    is_foot: bool
    ends_run: bool


class GroundKind(ParameterSet):
    """A packaged material, or the values of one."""

    words = 'material, or section'

    def read(self, tree: Any, place: Place) -> Ground:
        """Return the ground; as `ValueKind.read`."""
        if isinstance(tree, dict):
            read: Ground = super().read(tree, place)
            return read
        return build(Ground, *material_section(tree, str(place)))


def _point(value: Any, place: Place) -> tuple[float, float, float]:
    check(str(place), value, {'doc': 'point of a link', 'unit': 'mm', 'length': (3, 3),
                              'bounds': {'ge': -1e5, 'le': 1e5}})
    x, y, z = map(float, value)
    return x, y, z


POINT = Value('three numbers', _point, 'mm')
GROUND = GroundKind(Ground)
CONTACT = KeyTable((
    Key('link', TEXT, 'link of the URDF', None, 'of its name'),
    Key('at_mm', POINT, "its place in the link's axes", [0.0, 0.0, 0.0], 'the origin'),
    Key('ground', GROUND, 'the material there', None, '`ground` of the robot'),
    Key('is_foot', FLAG, 'whether it is a foot, whose force is published', False),
    Key('ends_run', FLAG, 'whether the run ends where it touches the ground', False)))


class Contacts(NamedSections):
    """Contacts by name, or by patterns of links, which `contacts_of` resolves."""

    words = 'sections by name or pattern'

    def read(self, tree: Any, place: Place) -> Any:
        """Return the sections as they are; as `ValueKind.read`."""
        return section_at(tree, place)


def contacts_of(
        given: YamlTree, ground: Ground | None, tree: RobotTree,
        place: Place) -> tuple[ContactConfig, ...]:
    """
    Return the contacts of a file; ``ground`` is that of a contact without its own.

    Raises
    ------
    ConfigError
        There is no such link, or a contact has no ground or the name of a joint.

    """
    links = [frame.name for frame in tree.frames]
    joints = [link.joint.name for link in tree.links[1:]]
    found = []
    for name, own in sections_by_name(given, links, place).items():
        below = place / name
        values: Mapping[str, Any] = CONTACT.read(own, below)
        link = values['link'] or name
        if link not in links:
            raise ConfigError(
                f'{below / "link" if values["link"] else below}: {link!r} is not a link of the '
                f'URDF; {alternatives(link, links)}')
        if name in joints:
            raise ConfigError(f'{below}: the name {name!r} is that of a joint; both have columns')
        own_ground = values['ground'] or ground
        if own_ground is None:
            raise ConfigError(below.has('lacks ground, and the robot has none: name a material'))
        found.append(ContactConfig(
            name=name, link=link, at_mm=values['at_mm'], ground=own_ground,
            is_foot=values['is_foot'], ends_run=values['ends_run']))
    return tuple(found)


def robot_contact(own: ContactConfig, tree: RobotTree) -> RobotContact:
    """Return a contact of the sheet of a robot, SI."""
    link, place = in_link(frame_named(tree, own.link), [MILLI * one for one in own.at_mm])
    return RobotContact(
        name=own.name, link=link, point=vector(place), ground=own.ground, frame=own.link,
        is_foot=own.is_foot, ends_run=own.ends_run)
