"""What waits for the first kernel of this process to be compiled."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache


class FirstCompilation:
    """Calls what waits for it once, when it begins."""

    def __init__(self) -> None:
        self._waiting: list[Callable[[], object]] = []

    @contextmanager
    def awaited_by(self, called: Callable[[], object]) -> Iterator[None]:
        """Return a context in which a function waits for it."""
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


@cache
def first_compilation() -> FirstCompilation:
    """Return that of the process, which has one compiler."""
    return FirstCompilation()
