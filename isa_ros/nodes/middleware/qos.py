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

SETPOINT = _reliable(1)
"""Setpoints: only the newest one is kept."""

LOCKSTEP = _reliable(64)
"""The private wire: the answers of all participants share one queue."""
