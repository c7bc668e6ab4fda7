"""Progress of a run on a terminal."""

from collections.abc import Callable
import sys
from typing import TextIO

from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.run.pacing import RunProgress
from isa_ros.text.progress import terminal_line


def terminal_report(stream: TextIO = sys.stderr) -> Callable[[RunProgress], None] | None:
    """Return a function that writes progress to ``stream``; None if it is not a terminal."""
    line = terminal_line(stream)
    if line is None:
        return None

    def report(progress: RunProgress) -> None:
        (line.end if progress.is_last else line.show)(progress_line(progress))
    return report


def progress_line(progress: RunProgress) -> str:
    """Return simulated time, real-time factor and time left in one line."""
    line = (f't = {progress.t_ns / NS_PER_SECOND:.3f} s, '
            f'{progress.real_time_factor:.2f} times real time')
    if progress.time_left_s is not None and not progress.is_last:
        line += f', {progress.time_left_s:.0f} s left'
    return line
