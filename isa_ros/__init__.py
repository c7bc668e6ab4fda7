"""Hydraulic integrated smart actuators as ROS 2 nodes stepped in lockstep."""
