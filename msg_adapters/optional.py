"""Message packages of ROS that nodes use where they are installed, and never require."""

from importlib.util import find_spec

SIMULATION = 'simulation_interfaces'

OPTIONAL = {
    SIMULATION: 'the standard services that pause, step and reset a run'}
"""Package -> what it is for."""


def is_installed(package: str) -> bool:
    """Return whether a package can be imported; a mere folder of its name is none."""
    found = find_spec(package)
    return found is not None and found.origin is not None
