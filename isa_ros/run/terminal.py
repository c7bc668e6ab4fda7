"""Progress of a run on a terminal, and only there."""

from collections.abc import Callable
import sys
from typing import TextIO

from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.run.pacing import Progress


def terminal_report(stream: TextIO = sys.stderr) -> Callable[[Progress], None] | None:
    """Return what writes progress to ``stream``; None where it is no terminal."""
    if not stream.isatty():
        return None

    def report(progress: Progress) -> None:
        stream.write(f'\r{progress_line(progress)}\033[K{chr(10) if progress.is_last else ""}')
        stream.flush()
    return report


def progress_line(progress: Progress) -> str:
    """Return simulated time, real-time factor and time left in one line."""
    line = (f't = {progress.t_ns / NS_PER_SECOND:.3f} s, '
            f'{progress.real_time_factor:.2f} times real time')
    if progress.time_left_s is not None and not progress.is_last:
        line += f', {progress.time_left_s:.0f} s left'
    return line
