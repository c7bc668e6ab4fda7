"""Frames of the links of a URDF, and points in them."""

from isa_ros.config.robots.tree import RobotTree
from isa_ros.surroundings.bodies.robot.sheet import RobotFrame
import numpy as np


def frame_named(tree: RobotTree, name: str | None) -> RobotFrame:
    """Return the frame of a link of the URDF, which there is."""
    return next(frame for frame in tree.frames if frame.name == name)


def in_link(frame: RobotFrame, place: list[float]) -> tuple[int, list[float]]:
    """Return the link of the tree that a frame is fixed to, and a point (m) in its axes."""
    found = np.array(frame.place) + np.array(frame.rotation) @ np.array(place)
    return frame.link, found.tolist()
