"""The node of one actuator: with a coordinator, or alone."""
