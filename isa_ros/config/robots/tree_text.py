"""Keys of the tree of a robot in a resolved text, which so needs no URDF; every bit is kept."""

from itertools import chain
import math
from typing import Any

from isa_ros.config.robots.tree import RobotTree
from isa_ros.config.text.key_tables import KeyTable, NamedSections
from isa_ros.config.text.keys import choice_of, Key, ParameterSet, TEXT, Value
from isa_ros.config.text.sections import Place, section_at
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import check, numbers, parameter, Parameters
from isa_ros.surroundings.bodies.robot.sheet import (
    matrix, RobotFrame, RobotJoint, RobotLink, vector)


@frozen(kw_only=True)
class FramePlace(Parameters):
    """Place and rotation of a frame, m, in the axes of another one."""

    place: tuple[float, ...] = numbers(
        'of its origin', 'm', least=3, most=3, ge=-1e4, le=1e4)
    rotation: tuple[float, ...] = numbers(
        'row by row; its axes are the columns', '1', least=9, most=9, ge=-1.001, le=1.001)


@frozen(kw_only=True)
class LinkValues(FramePlace):
    """A link, and the frame of its joint at coordinate 0 in its parent, with z as axis."""

    mass: float = parameter('mass', 'kg', ge=0.0, le=1e7)
    com: tuple[float, ...] = numbers(
        'centre of mass, link axes', 'm', least=3, most=3, ge=-1e4, le=1e4)
    inertia: tuple[float, ...] = numbers(
        'xx, yy, zz, xy, xz, yz about it', 'kg m2', least=6, most=6, ge=-1e9, le=1e9)


def _index(value: Any, place: Place) -> int:
    check(str(place), value, {'doc': 'index of a link', 'unit': '1', 'is_whole': True,
                              'bounds': {'ge': -1.0, 'le': 1e4}})
    return int(value)


def _range(value: Any, place: Place) -> tuple[float, float]:
    check(str(place), value, {
        'doc': 'lower and upper end', 'unit': '', 'length': (2, 2), 'bounds': {}})
    low, high = map(float, value)
    return low, high


def _range_of(link: RobotLink) -> tuple[float, float] | None:
    ends = link.joint.low, link.joint.high
    return ends if all(map(math.isfinite, ends)) else None


def _values(link: RobotLink) -> LinkValues:
    return LinkValues(
        place=link.joint.place, rotation=tuple(chain(*link.joint.rotation)), mass=link.mass,
        com=link.com, inertia=link.inertia)


class LinkSections(NamedSections):
    """Sections by the names of a URDF, which may have capital letters."""

    def read(self, tree: Any, place: Place) -> dict[str, Any]:
        """Return the values by name; as `ValueKind.read`."""
        return {name: self.section.read(below, place / name)
                for name, below in section_at(tree, place).items()}


LINK = KeyTable((
    Key('parent', Value('whole number', _index), 'index of the link that it is joined to'),
    Key('joint', TEXT, 'name of its joint', of=lambda link: link.joint.name),
    Key('kind', choice_of(('free', 'fixed', 'revolute', 'prismatic')), 'kind of its joint',
        of=lambda link: link.joint.kind),
    Key('range', Value('two numbers', _range, 'rad | m'), 'range of its joint', None,
        of=_range_of)),
    rest=Key('values', ParameterSet(LinkValues), '', of=_values))
FRAME = KeyTable((
    Key('link', Value('whole number', _index), 'index of the link that it is fixed to'),),
    rest=Key('values', ParameterSet(FramePlace), '', of=lambda frame: FramePlace(
        place=frame.place, rotation=tuple(chain(*frame.rotation)))))
TREE = KeyTable((
    Key('links', LinkSections(LINK), 'links in depth-first order, the root first'),
    Key('frames', LinkSections(FRAME), 'the links of the URDF')))


def tree_from(values: dict[str, Any]) -> RobotTree:
    """Return the tree of the values of `TREE`."""
    links = []
    for name, own in values['links'].items():
        given: LinkValues = own['values']
        low, high = own['range'] or (-math.inf, math.inf)
        x_x, y_y, z_z, x_y, x_z, y_z = given.inertia
        links.append(RobotLink(
            name=name, parent=own['parent'], mass=given.mass, com=vector(given.com),
            inertia=(x_x, y_y, z_z, x_y, x_z, y_z), joint=RobotJoint(
                name=own['joint'], kind=own['kind'], place=vector(given.place),
                rotation=_matrix(given.rotation), low=low, high=high)))
    frames = [RobotFrame(name=name, link=own['link'], place=vector(own['values'].place),
                         rotation=_matrix(own['values'].rotation))
              for name, own in values['frames'].items()]
    return RobotTree(tuple(links), tuple(frames))


def _matrix(numbers_of: tuple[float, ...]) -> Any:
    return matrix([numbers_of[0:3], numbers_of[3:6], numbers_of[6:9]])
