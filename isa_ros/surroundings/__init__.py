"""Surroundings that the actuators of a run share: supplies, and the body they move."""
