"""
The description of a robot of a run, for robot_state_publisher: its URDF with the frames of a run.

Links have the prefix of the robot in front, so that they are the frames of its messages; joints
keep their names. Each actuator and its load cell have frames, fixed to the link that carries the
cylinder: at the joint of a linkage, at the pin of a cylinder between two links.
"""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from xml.etree import ElementTree

from isa_ros.config.paths import find_drawing
from isa_ros.config.robots.drives import CylinderBetweenLinks, DriveConfig
from isa_ros.core.units import MILLI

Element = ElementTree.Element


def description_of(
        urdf: str, prefix: str, drives: Sequence[DriveConfig], folder: Path,
        control: Iterable[str] = ()) -> str:
    """
    Return the description of a robot by its URDF, whose run file is in ``folder``.

    ``prefix`` is that of its frames, ``control`` a tag of ros2_control.

    Raises
    ------
    ConfigError
        Its URDF is neither there nor shipped.

    """
    beside = folder / urdf
    path = beside if beside.is_file() else find_drawing(f'urdf/{urdf}')
    root = ElementTree.parse(path).getroot()
    root.extend(_mounts(drives, root))
    own = {f'{drive.actuator}{end}' for drive in drives for end in ('', '_load_cell')}
    for name in _names(root):
        if (text := name.get(_key(name), '')) not in own:
            name.set(_key(name), f'{prefix}{text}')
    if lines := [*control]:
        root.append(ElementTree.fromstring('\n'.join(lines)))
    ElementTree.indent(root)
    return f'<?xml version="1.0"?>\n{ElementTree.tostring(root, encoding="unicode")}\n'


def _key(element: Element) -> str:
    return 'name' if element.tag == 'link' else 'link'


def _names(root: Element) -> Iterator[Element]:
    """Yield the elements that name links: these themselves, and both ends of joints."""
    yield from root.iterfind('link')
    for joint in root.iterfind('joint'):
        yield from joint.iterfind('parent')
        yield from joint.iterfind('child')


def _mounts(drives: Sequence[DriveConfig], root: Element) -> list[Element]:
    """Return links and fixed joints of the frames of the actuators."""
    there = {link.get('name') for link in root.iterfind('link')}
    found: list[Element] = []
    for drive in drives:
        if drive.actuator in there:     # a link of the URDF has its name
            continue
        parent, origin = _carried(drive, root)
        for link, above, place in (
                (drive.actuator, parent, origin),
                (f'{drive.actuator}_load_cell', drive.actuator, {})):
            found.append(Element('link', name=link))
            joint = Element('joint', name=f'{link}_mount', type='fixed')
            joint.append(Element('parent', link=above))
            joint.append(Element('child', link=link))
            if place:
                joint.append(Element('origin', place))
            found.append(joint)
    return found


def _carried(drive: DriveConfig, root: Element) -> tuple[str, dict[str, str]]:
    """Return the link that carries an actuator, and its place there."""
    if isinstance(drive.linkage, CylinderBetweenLinks):
        pin = ' '.join(f'{MILLI * one:.9g}' for one in drive.linkage.base_mm)
        return str(drive.base), {'xyz': pin, 'rpy': '0 0 0'}
    joint = next(own for own in root.iterfind('joint') if own.get('name') == drive.joint)
    parent, origin = joint.find('parent'), joint.find('origin')
    assert parent is not None
    return parent.get('link', ''), {} if origin is None else dict(origin.attrib)
