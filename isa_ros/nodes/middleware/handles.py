"""Availability of rclpy's semi-private handles."""

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy


def has_handles() -> bool:
    """Return whether rclpy has the semi-private handles that `WaitSetMailbox` uses."""
    needed = {
        'WaitSet': ('clear_entities', 'add_subscription', 'wait'),
        'Subscription': ('take_message', 'get_publisher_count'),
        'Service': ('service_take_request',),
    }
    return all(hasattr(getattr(_rclpy, owner, None), name)
               for owner, names in needed.items() for name in names)
