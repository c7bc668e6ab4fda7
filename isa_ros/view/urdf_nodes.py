"""
The links of a URDF as nodes: https://wiki.ros.org/urdf/XML.

Drawn are boxes, cylinders and spheres; a mesh is left out, since its file is not read.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple
from xml.etree.ElementTree import Element

from isa_ros.config.robots.urdf_numbers import axis_of, number_of, numbers_of, origin_of
from isa_ros.config.robots.urdf_text import element_of
from isa_ros.errors import ConfigError
from isa_ros.view.nodes import Floats, SceneMotion, SceneNode, Shape, WORLD
import numpy as np

_MOTIONS = {'revolute': SceneMotion.TURN, 'continuous': SceneMotion.TURN,
            'prismatic': SceneMotion.SLIDE}
_SIZES = {'box': ('size', 3), 'cylinder': ('radius length', 2), 'sphere': ('radius', 1)}


class Moved(NamedTuple):
    """What moves the joints of a URDF."""

    joints: Mapping[str, str]
    """Channel of each joint by name; one without a channel rests at 0."""
    root: Sequence[str]
    """Channels of the pose of a free root; empty: it stands still."""
    place: Floats
    """Of its world in that of the page, m, (3,)."""


def urdf_nodes(text: str, name: str, moved: Moved, first: int) -> list[SceneNode]:
    """
    Return the nodes of a URDF, of which the root is the ``first`` in the list of all.

    Raises
    ------
    ConfigError
        It is not a URDF of one tree, or a number is not finite; the message begins with ``name``.

    """
    top = element_of(text, name)
    links = {link.get('name', ''): link for link in top.iterfind('link')}
    by_parent: dict[str, list[Element]] = {}
    children: set[str] = set()
    for joint in top.iterfind('joint'):
        child = _end(joint, 'child')
        if child in children:
            raise ConfigError(f'{name}: {child} is the child of two joints, must be of one')
        by_parent.setdefault(_end(joint, 'parent'), []).append(joint)
        children.add(child)
    roots = [link for link in links if link not in children]
    if len(roots) != 1:
        raise ConfigError(f'{name}: has {len(roots)} links without a parent, must have one')
    found = [SceneNode(roots[0], WORLD, moved.place, np.eye(3), ())]
    if moved.root:
        found.append(SceneNode(roots[0], first, np.zeros(3), np.eye(3), (), SceneMotion.FREE,
                               channels=moved.root))
    _add(found, links, by_parent, moved, first, name)
    return found


def _add(found: list[SceneNode], links: Mapping[str, Element],
         by_parent: Mapping[str, list[Element]], moved: Moved, first: int, name: str) -> None:
    """Add the links below the last node, and its own shapes."""
    waiting = [len(found) - 1]
    while waiting:
        at = waiting.pop()
        node = found[at]
        link = links.get(node.name)
        if link is None:
            raise ConfigError(f'{name}: {node.name} is the child of a joint, and not a link')
        found[at] = node._replace(shapes=[*_shapes(link, f'{name}: link {node.name}')])
        for joint in by_parent.get(node.name, ()):
            where = f'{name}: joint {joint.get("name", "")}'
            place, rotation = origin_of(joint, where)
            motion, axis, channels = _motion(joint, moved, where)
            found.append(SceneNode(_end(joint, 'child'), first + at, place, rotation, (), motion,
                                   axis, channels))
            waiting.append(len(found) - 1)


def _end(joint: Element, side: str) -> str:
    found = joint.find(side)
    return '' if found is None else found.get('link', '')


def _motion(
        joint: Element, moved: Moved, where: str
        ) -> tuple[SceneMotion, Sequence[float], Sequence[str]]:
    """Return how a joint moves, its axis of length 1, and its channels."""
    motion = _MOTIONS.get(joint.get('type', ''), SceneMotion.FIXED)
    channel = moved.joints.get(joint.get('name', ''))
    if motion is SceneMotion.FIXED or channel is None:
        return SceneMotion.FIXED, (0.0, 0.0, 1.0), ()
    return motion, axis_of(joint, where).tolist(), (channel,)


def _shapes(link: Element, where: str) -> Iterator[Shape]:
    for visual in link.iterfind('visual'):
        geometry = visual.find('geometry')
        for own in () if geometry is None else geometry:
            if own.tag not in _SIZES:
                continue
            keys, n = _SIZES[own.tag]
            part = f'{where}: {own.tag}'
            words = keys.split()
            size = numbers_of(own, words[0], n, part) if len(words) == 1 else [
                number_of(own, word, part) for word in words]
            place, rotation = origin_of(visual, where)
            yield Shape(own.tag, size, place, rotation)
