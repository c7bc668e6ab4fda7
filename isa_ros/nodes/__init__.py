"""ROS 2 nodes: the only package that imports rclpy."""

from isa_ros.nodes.participant import Participant

__all__ = ['Participant']
