"""The ROS 2 face: the only package that imports rclpy."""

from isa_ros.nodes.participant import Participant

__all__ = ['Participant']
