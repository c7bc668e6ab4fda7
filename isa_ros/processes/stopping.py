"""Ctrl-C, SIGTERM and SIGHUP as a stop request that takes effect between two ticks."""

import signal
from types import FrameType

from isa_ros.processes.ending import replaced_handlers


class StopRequest:
    """Becomes true at the first signal that asks to end; a context manager, main thread only."""

    def __init__(self) -> None:
        self._is_set = False

    def __call__(self) -> bool:
        """Return whether a stop was requested."""
        return self._is_set

    def __enter__(self) -> 'StopRequest':
        self._before = replaced_handlers(self._on_signal)
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        self._is_set = True
