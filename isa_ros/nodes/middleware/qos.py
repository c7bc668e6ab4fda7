"""Qualities of service of all topics."""

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy


def _reliable(
        depth: int, durability: DurabilityPolicy = DurabilityPolicy.VOLATILE) -> QoSProfile:
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST, depth=depth,
        reliability=ReliabilityPolicy.RELIABLE, durability=durability)


STATE = _reliable(10)
"""Published state; also the profile stored in a bag."""

KEPT = _reliable(10, DurabilityPolicy.TRANSIENT_LOCAL)
"""Applied setpoints and parameters: a later subscription receives the last ones."""

MOVING = _reliable(100)
"""Transforms that change, as tf2 publishes them."""

FIXED = _reliable(1, DurabilityPolicy.TRANSIENT_LOCAL)
"""Transforms that stay."""

SETPOINT = _reliable(100)
"""
Setpoints: all that arrive between two ticks are taken in their order, and the last one wins.

With one place a message that is refused, or is for another joint, would push out a valid one.
"""

LOCKSTEP = _reliable(64)
"""The private wire: the answers of all participants share one queue."""
