"""What one actuator alone moves, and the port between an actuator and its load."""
