"""One parameter varied against the performance of an actuator."""
