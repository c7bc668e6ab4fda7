"""The node of one actuator: under a coordinator, or alone."""
