"""Short-lived nodes of the command line, for hosts without `ros2`: echo, set, command."""
