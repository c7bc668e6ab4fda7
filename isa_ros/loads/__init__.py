"""Loads of a single actuator, and the port between an actuator and its load."""
