"""ROS 2 nodes: the only package that imports rclpy."""

from typing import Any, TYPE_CHECKING

if TYPE_CHECKING:
    from isa_ros.nodes.participant import Participant as Participant

__all__ = ['Participant']  # noqa: F822, it is loaded by `__getattr__`


def __getattr__(name: str) -> Any:
    """Load a public name where it is used first: an actuator alone needs no lockstep."""
    if name not in __all__:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    from isa_ros.nodes.participant import Participant
    return Participant
