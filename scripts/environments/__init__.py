"""Environments in which the package is tried: `check_environments`, `check_colcon`."""
