"""
Numbers, places and axes in a URDF: https://wiki.ros.org/urdf/XML.

Messages begin with ``where``, the file with link or joint, and name element and attribute.
"""

from collections.abc import Sequence
import math
from typing import NamedTuple
from xml.etree.ElementTree import Element

from isa_ros.core.elementary import cos, sin
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.robot.sheet import ORIGIN
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_ROUNDING = 1e-15       # of the sine of pi, of which a turn by 90 deg is free
ALONG_X = (1.0, 0.0, 0.0)
_COUNTS = {1: 'a number', 3: 'three numbers'}


class Pose(NamedTuple):
    """A frame in the axes of another one."""

    place: Floats
    """m, (3,)."""
    rotation: Floats
    """Its axes in the columns, (3, 3)."""


def origin_of(element: Element, where: str) -> Pose:
    """
    Return the ``<origin>`` below an element; the frame itself without one.

    Raises
    ------
    ConfigError
        Its place or angles are not of three finite numbers.

    """
    found = element.find('origin')
    if found is None:
        return Pose(np.zeros(3), np.eye(3))
    where = f'{where}: origin'
    return Pose(np.array(numbers_of(found, 'xyz', 3, where, ORIGIN)),
                turned(*numbers_of(found, 'rpy', 3, where, ORIGIN)))


def axis_of(joint: Element, where: str) -> Floats:
    """
    Return the axis of a joint that moves, of length 1, joint axes, (3,); without ``<axis>`` x.

    Raises
    ------
    ConfigError
        It has no direction, or is not of three finite numbers.

    """
    given = joint.find('axis')
    if given is None:
        return np.array(ALONG_X)
    axis = np.array(numbers_of(given, 'xyz', 3, f'{where}: axis'))
    length = math.sqrt(float(axis @ axis))
    if length == 0.0:
        raise ConfigError(f'{where}: axis xyz = 0 0 0, must have a direction')
    return axis / length


def turned(roll: float, pitch: float, yaw: float) -> Floats:
    """Return R_z(yaw) R_y(pitch) R_x(roll), (3, 3), with exact zeros in turns by 90 deg."""
    (s_r, c_r), (s_p, c_p), (s_y, c_y) = (
        (sin(angle), cos(angle)) for angle in map(float, (roll, pitch, yaw)))
    rotation = np.array([
        [c_y * c_p, c_y * s_p * s_r - s_y * c_r, c_y * s_p * c_r + s_y * s_r],
        [s_y * c_p, s_y * s_p * s_r + c_y * c_r, s_y * s_p * c_r - c_y * s_r],
        [-s_p, c_p * s_r, c_p * c_r]])
    return np.where(np.abs(rotation) < _ROUNDING, 0.0, rotation)


def number_of(element: Element, key: str, where: str, default: float | None = None) -> float:
    """Return the number of an attribute; as `numbers_of`."""
    return numbers_of(element, key, 1, where, None if default is None else (default,))[0]


def numbers_of(
        element: Element, key: str, n: int, where: str, default: Sequence[float] | None = None
        ) -> Sequence[float]:
    """
    Return the n numbers of an attribute, one or three; None: it has no default.

    Raises
    ------
    ConfigError
        There are more or fewer, or one is not finite.

    """
    text = element.get(key)
    if text is None and default is not None:
        return default
    found = []
    for word in (text or '').split():
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise ConfigError(f'{where} {key} = {text!r}, must be finite numbers')
        found.append(value)
    if len(found) != n:
        raise ConfigError(f'{where} {key} = {text!r}, must be {_COUNTS[n]}')
    return found
