"""The tick of a run: rows between actuators, surroundings and controllers."""
