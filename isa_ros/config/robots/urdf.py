"""
Links and joints of a URDF, as they are written: https://wiki.ros.org/urdf/XML.

Read are names, parents, places, axes, ranges and inertias; shapes, colours and extensions are
skipped.
"""

import math
from pathlib import Path
import re
from xml.etree.ElementTree import Element

from isa_ros.config.robots.urdf_numbers import (
    ALONG_X, axis_of, Floats, number_of, origin_of, Pose)
from isa_ros.config.robots.urdf_text import element_of
from isa_ros.core.frozen import frozen
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError
import numpy as np

MAX_BYTES = 16 << 20    # of one file; meshes are in files of their own
JOINT_KINDS = ('revolute', 'continuous', 'prismatic', 'fixed', 'floating')
_NAME = re.compile('[A-Za-z][A-Za-z0-9_]*')
_IMPOSSIBLE = 1e-3      # by which a principal moment may exceed the sum of the two others


@frozen(eq=False)
class UrdfLink:
    """A link: its mass and inertia, 0 without ``<inertial>``."""

    name: str
    mass: float
    """kg."""
    com: Floats
    """Centre of mass, m, link axes, (3,)."""
    inertia: Floats
    """About the centre of mass, kg m2, link axes, (3, 3)."""


@frozen(eq=False)
class UrdfJoint:
    """A joint: the frame of ``child`` in that of ``parent`` at coordinate 0."""

    name: str
    kind: str
    """One of `JOINT_KINDS`."""
    parent: str
    child: str
    origin: Pose
    axis: Floats
    """Of length 1, axes of the child, (3,)."""
    low: float
    """rad or m; infinite for a continuous joint."""
    high: float


@frozen(eq=False)
class Urdf:
    """A URDF: every link but ``root`` is the child of one joint."""

    name: str
    links: dict[str, UrdfLink]
    joints: tuple[UrdfJoint, ...]
    """In the order of the file."""
    root: str


def load_urdf(path: Path) -> Urdf:
    """Return the content of a file; as `read_urdf`."""
    try:
        with path.open('rb') as file:
            raw = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise ConfigError(f'{path}: cannot be read: {error.strerror}') from error
    if len(raw) > MAX_BYTES:
        raise ConfigError(f'{path.name}: larger than {MAX_BYTES} bytes, must be smaller')
    return read_urdf(raw, path.name)


def read_urdf(text: str | bytes, name: str) -> Urdf:
    """
    Return the links and joints of a URDF; messages begin with ``name``.

    Raises
    ------
    ConfigError
        The text is not a URDF of one tree, or has a joint or an inertia that no robot has; the
        message names link or joint.

    """
    top = element_of(text, name)
    if top.tag != 'robot':
        raise ConfigError(f'{name}: its element is <{top.tag}>, must be <robot>')
    links: dict[str, UrdfLink] = {}
    for element in top.findall('link'):
        where = f'{name}: link {_named(element, "link", name)}'
        if element.get('name') in links:
            raise ConfigError(f'{where} is there twice')
        links[element.attrib['name']] = _link(element, where)
    joints: dict[str, UrdfJoint] = {}
    for element in top.findall('joint'):
        where = f'{name}: joint {_named(element, "joint", name)}'
        if element.get('name') in joints:
            raise ConfigError(f'{where} is there twice')
        joints[element.attrib['name']] = _joint(element, where, links)
    root = _root(links, tuple(joints.values()), name)
    return Urdf(top.get('name', ''), links, tuple(joints.values()), root)


def _named(element: Element, what: str, name: str) -> str:
    """Return the name of a link or joint, which columns and topics have too."""
    own = element.get('name', '')
    if not _NAME.fullmatch(own):
        raise ConfigError(
            f'{name}: a {what} has the name {own!r}, must be letters, digits and underscores, a '
            'letter first')
    return own


def _root(links: dict[str, UrdfLink], joints: tuple[UrdfJoint, ...], name: str) -> str:
    """Return the link without a parent, and refuse what is not one tree."""
    parents: dict[str, UrdfJoint] = {}
    for joint in joints:
        if joint.child in parents:
            raise ConfigError(
                f'{name}: link {joint.child} is the child of {parents[joint.child].name} and '
                f'{joint.name}, must be of one joint: a closed loop is a linkage of a drive')
        parents[joint.child] = joint
    roots = [own for own in links if own not in parents]
    if not links or len(roots) > 1:
        raise ConfigError(
            f'{name}: has {len(roots)} links without a parent'
            f'{": " if roots else ""}{", ".join(roots)}; must have one, the root')
    for link in links:
        seen = [link]
        while seen[-1] in parents:
            seen.append(parents[seen[-1]].parent)
            if seen[-1] in seen[:-1]:
                raise ConfigError(f'{name}: link {link} is its own parent, by the joints of '
                                  f'{", ".join(seen[:-1])}')
    return roots[0]


def _link(element: Element, where: str) -> UrdfLink:
    inertial = element.find('inertial')
    if inertial is None:
        return UrdfLink(element.attrib['name'], 0.0, np.zeros(3), np.zeros((3, 3)))
    mass = number_of(_below(inertial, 'mass', where), 'value', f'{where}: mass')
    if mass < 0.0:
        raise ConfigError(f'{where}: mass value = {mass:g} kg, must be >= 0 kg')
    given = _below(inertial, 'inertia', where)
    xx, xy, xz, yy, yz, zz = (number_of(given, key, f'{where}: inertia') for key in (
        'ixx', 'ixy', 'ixz', 'iyy', 'iyz', 'izz'))
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    moments = np.linalg.eigvalsh(inertia)
    if moments[0] < 0.0 or (mass == 0.0 and moments[2] > 0.0):
        raise ConfigError(
            f'{where}: inertia has the principal moments {_numbers(moments)} kg m2, must be >= 0'
            f'{", and 0 without mass" if mass == 0.0 else ""}')
    if moments[2] > (1.0 + _IMPOSSIBLE) * (moments[0] + moments[1]):
        raise ConfigError(
            f'{where}: inertia has the principal moments {_numbers(moments)} kg m2, the largest '
            'must be <= the sum of the two others, as of any rigid body')
    origin = origin_of(inertial, where)
    return UrdfLink(element.attrib['name'], mass, origin.place,
                    origin.rotation @ inertia @ origin.rotation.T)


def _joint(element: Element, where: str, links: dict[str, UrdfLink]) -> UrdfJoint:
    kind = element.get('type', '')
    if kind not in JOINT_KINDS:
        raise ConfigError(
            f'{where}: type = {kind!r}, must be one of {", ".join(JOINT_KINDS)}')
    if element.find('mimic') is not None:
        raise ConfigError(
            f'{where}: has <mimic>, which is not read: a joint that follows another one is part '
            'of a linkage of a drive')
    parent, child = (_below(element, side, where).get('link', '')
                     for side in ('parent', 'child'))
    for side, link in (('parent', parent), ('child', child)):
        if link not in links:
            raise ConfigError(f'{where}: {side} = {link!r} is not a link; '
                              f'{alternatives(link, list(links))}')
    axis = np.array(ALONG_X) if kind in ('fixed', 'floating') else axis_of(element, where)
    low, high = _range(element, kind, where)
    return UrdfJoint(
        element.attrib['name'], kind, parent, child, origin_of(element, where), axis, low, high)


def _range(element: Element, kind: str, where: str) -> tuple[float, float]:
    """Return the range of a joint, rad or m."""
    if kind not in ('revolute', 'prismatic'):
        return -math.inf, math.inf
    limit = element.find('limit')
    if limit is None:
        raise ConfigError(
            f'{where}: has no <limit lower upper>, which a {kind} joint needs'
            f'{"; without a range its type is continuous" if kind == "revolute" else ""}')
    low, high = (number_of(limit, key, f'{where}: limit', 0.0) for key in ('lower', 'upper'))
    if not low < high:
        unit = 'rad' if kind == 'revolute' else 'm'
        raise ConfigError(
            f'{where}: limit lower = {low:g} {unit}, must be < upper = {high:g} {unit}')
    return low, high


def _below(element: Element, tag: str, where: str) -> Element:
    found = element.find(tag)
    if found is None:
        raise ConfigError(f'{where}: <{element.tag}> lacks <{tag}>')
    return found


def _numbers(values: Floats) -> str:
    return ', '.join(f'{value:.3g}' for value in values)
