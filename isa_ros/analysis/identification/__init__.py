"""Parameters of an actuator out of what its sensors recorded."""
