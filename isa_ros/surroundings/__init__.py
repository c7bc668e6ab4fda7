"""Surroundings of the actuators of a run: the supplies, and the body that they move."""
