"""The qualities of service of every topic."""

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy


def _reliable(depth: int) -> QoSProfile:
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST, depth=depth,
        reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.VOLATILE)


STATE = _reliable(10)
"""What nodes publish; the profile that a bag states."""

SETPOINT = _reliable(1)
"""Only the newest setpoint counts."""

LOCKSTEP = _reliable(64)
"""The private wire: acknowledgements of all participants share one queue."""
