"""
What the page draws in 3D, as data: a tree of frames with simple shapes, moved by channels.

A channel is the name of one number of a sample: ``body.position[0]``, ``ram.position``. Lengths
are m; the first node has its frame in that of the world, z up, the floor at z = 0.
"""

from collections.abc import Sequence
from enum import Enum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

WORLD = -1
"""Parent of a node in the world."""


class Shape(NamedTuple):
    """A body in the axes of its node; a cylinder is along z."""

    kind: str
    """box, cylinder or sphere."""
    size: Sequence[float]
    """Edges x, y, z; radius and length; radius."""
    place: Floats
    """Of its centre, (3,)."""
    rotation: Floats
    """Its axes in the columns, (3, 3)."""
    color: int = 0
    """Of the page's colours."""


class SceneMotion(Enum):
    """How the channels of a node move it after its place and rotation."""

    FIXED = 'fixed'
    """Without a channel."""
    TURN = 'turn'
    """About its axis by an angle, rad."""
    SLIDE = 'slide'
    """Along its axis, m."""
    FREE = 'free'
    """x, y, z, and a quaternion w, x, y, z."""


class SceneNode(NamedTuple):
    """A frame in the axes of its parent, which stands before it."""

    name: str
    parent: int
    place: Floats
    """(3,)."""
    rotation: Floats
    """(3, 3)."""
    shapes: Sequence[Shape]
    motion: SceneMotion = SceneMotion.FIXED
    axis: Sequence[float] = (0.0, 0.0, 1.0)
    channels: Sequence[str] = ()
    reach: float = 0.0
    """How far it slides, m, so that all of it is in view."""


def tree_of(nodes: Sequence[SceneNode], place_of: dict[str, int]) -> list[dict[str, Any]]:
    """Return nodes for JSON; ``place_of`` are the places of the channels in a frame."""
    return [{
        'name': node.name, 'parent': node.parent, 'place': _numbers(node.place),
        'rotation': _numbers(node.rotation), 'motion': node.motion.value,
        'axis': [*node.axis], 'channels': [place_of[name] for name in node.channels],
        'reach': node.reach,
        'shapes': [{
            'kind': own.kind, 'size': [*own.size], 'place': _numbers(own.place),
            'rotation': _numbers(own.rotation), 'color': own.color} for own in node.shapes],
        } for node in nodes]


def _numbers(values: Floats) -> list[float]:
    """Return an array as numbers, row by row."""
    found: list[float] = values.ravel().tolist()
    return found
