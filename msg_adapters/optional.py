"""Message packages of ROS that nodes use where they are installed, and never require."""

from importlib.util import find_spec

SIMULATION, TRANSFORMS = 'simulation_interfaces', 'tf2_msgs'

OPTIONAL = {
    SIMULATION: 'the standard services that pause, step and reset a run',
    TRANSFORMS: 'where robots are, on tf and tf_static'}
"""Package -> what it is for."""


def is_installed(package: str) -> bool:
    """Return whether a package can be imported; a mere folder of its name is none."""
    found = find_spec(package)
    return found is not None and found.origin is not None
