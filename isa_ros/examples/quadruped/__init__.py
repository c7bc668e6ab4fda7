"""A quadruped that stands, squats and trots: a controller to copy and to replace."""
