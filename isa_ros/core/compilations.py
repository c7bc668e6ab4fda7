"""What waits for the first kernel to be compiled, and what is told of those of other processes."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any, Protocol


class Watcher(Protocol):
    """Is told of each kernel as it begins to be compiled, and as it ends."""

    def start(self, kernel: Any) -> None:
        """Note the kernel."""

    def end(self) -> None:
        """Note the end of the last one that has not ended."""


class Compilations:
    """
    Those of a process.

    Numba tells of the kernels that it compiles here by itself; `large_kernels` tells of those that
    another process lowers.
    """

    def __init__(self) -> None:
        self._waiting: list[Callable[[], object]] = []
        self._watchers: list[Watcher] = []

    @contextmanager
    def awaited_by(self, called: Callable[[], object]) -> Iterator[None]:
        """Return a context in which a function waits for the first one."""
        self._waiting.append(called)
        try:
            yield
        finally:
            if called in self._waiting:
                self._waiting.remove(called)

    def begin(self) -> None:
        """Call what waits, the last first; nothing is called twice."""
        while self._waiting:
            self._waiting.pop()()

    @contextmanager
    def watched_by(self, watcher: Watcher) -> Iterator[None]:
        """Return a context in which a watcher is told of kernels that another process lowers."""
        self._watchers.append(watcher)
        try:
            yield
        finally:
            self._watchers.remove(watcher)

    def start(self, kernel: Any) -> None:
        """Tell that a kernel begins."""
        for watcher in self._watchers:
            watcher.start(kernel)

    def end(self) -> None:
        """Tell that the last one ends."""
        for watcher in self._watchers:
            watcher.end()


@cache
def compilations() -> Compilations:
    """Return those of this process, which has one compiler."""
    return Compilations()
