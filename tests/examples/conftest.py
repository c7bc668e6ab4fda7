"""A ROS domain of its own, as in tests/ros."""

from tests.ros.conftest import domain

__all__ = ['domain']
