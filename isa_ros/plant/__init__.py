"""The hydraulic and mechanical parts of one actuator, one component a file."""
