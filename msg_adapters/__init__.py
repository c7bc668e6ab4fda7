"""Conversion between signals and ROS 2 messages, and the canonical CDR encoder."""
