"""What an actuator moves, and the port between the two."""
