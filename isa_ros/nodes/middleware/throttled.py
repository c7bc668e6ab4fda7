"""Warnings about messages of others, which may come with every tick."""

from collections.abc import Callable
import time

from rclpy.impl.rcutils_logger import RcutilsLogger

WARNING_PERIOD_S = 1.0
BURST = 4       # warnings in a row: those of a user who types one wrong command after the other


class ThrottledWarnings:
    """
    Logs warnings of one kind, for long one in `WARNING_PERIOD_S`, after a pause up to `BURST`.

    The throttle of rclpy looks up its caller in the sources for each warning, also for one that it
    discards: 0.3 ms, more than the tick of an actuator.
    """

    def __init__(
            self, log: RcutilsLogger, now: Callable[[], float] = time.monotonic) -> None:
        self._log, self._now, self._due = log, now, now()

    def __call__(self, line: str) -> None:
        """Log a line, unless as many as are allowed came just before."""
        now = self._now()
        if now >= self._due - (BURST - 1) * WARNING_PERIOD_S:
            self._due = max(now, self._due) + WARNING_PERIOD_S
            self._log.warning(line)
