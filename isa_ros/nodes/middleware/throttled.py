"""Warnings about messages of others, which may come with every tick."""

import time

from rclpy.impl.rcutils_logger import RcutilsLogger

WARNING_PERIOD_S = 1.0


class ThrottledWarnings:
    """
    Logs warnings of one kind, at most one in `WARNING_PERIOD_S`.

    The throttle of rclpy looks up its caller in the sources for each warning, also for one that it
    discards: 0.3 ms, more than the tick of an actuator.
    """

    def __init__(self, log: RcutilsLogger) -> None:
        self._log, self._due = log, time.monotonic()

    def __call__(self, line: str) -> None:
        """Log a line, unless the last one is younger than the period."""
        now = time.monotonic()
        if now >= self._due:
            self._due = now + WARNING_PERIOD_S
            self._log.warning(line)
