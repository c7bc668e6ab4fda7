"""Progress of long work: one line of a terminal, overwritten until the work ends."""

from collections.abc import Callable, Collection, Iterator
import contextlib
import threading
import time
from typing import Protocol, TextIO, TypeVar

_Piece = TypeVar('_Piece')

_TO_THE_LEFT, _CLEAR_THE_REST = '\r', '\033[K'
PERIOD_S = 1.0      # between two times that a line shows


class TerminalLine:
    """One line of a terminal."""

    def __init__(self, terminal: TextIO) -> None:
        self._terminal = terminal

    def show(self, text: str) -> None:
        """Replace the text of the line."""
        self._write(text)

    def end(self, text: str) -> None:
        """Replace the text of the line and begin a new line."""
        self._write(text, '\n')

    def erase(self) -> None:
        """Clear the line."""
        self._write('')

    def _write(self, text: str, end: str = '') -> None:
        with contextlib.suppress(OSError):  # the terminal was closed: the work ends, or goes on
            self._terminal.write(f'{_TO_THE_LEFT}{text}{_CLEAR_THE_REST}{end}')
            self._terminal.flush()


def terminal_line(stream: TextIO) -> TerminalLine | None:
    """Return the line to show progress on; None if ``stream`` is not a terminal."""
    return TerminalLine(stream) if stream.isatty() else None


@contextlib.contextmanager
def repeated(show: Callable[[], object], period_s: float = PERIOD_S) -> Iterator[None]:
    """Call a function in every period of the context, from a thread of its own."""
    ended = threading.Event()

    def repeat() -> None:
        while not ended.wait(period_s):
            show()
    thread = threading.Thread(target=repeat, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


@contextlib.contextmanager
def underway(
        stream: TextIO, text: str, clock: Callable[[], float] = time.monotonic,
        period_s: float = PERIOD_S) -> Iterator[None]:
    """
    Show what is done and the time spent, for as long as it takes.

    Nothing is shown where ``stream`` is not a terminal.
    """
    line = terminal_line(stream)
    if line is None:
        yield
        return
    start = clock()
    line.show(text)
    try:
        with repeated(lambda: line.show(f'{text}, {clock() - start:.0f} s'), period_s):
            yield
    finally:
        line.erase()


class Progress(Protocol):
    """Function with the numbers of finished and of all pieces, and a name of the next one."""

    def __call__(self, done: int, total: int, what: str = '') -> None:
        """Show the progress."""


def told(pieces: Collection[_Piece], progress: Progress | None) -> Iterator[_Piece]:
    """Yield each piece, and show it as finished when the next one is asked for."""
    for done, piece in enumerate(pieces, 1):
        yield piece
        if progress is not None:
            progress(done, len(pieces))


def counted(
        stream: TextIO, pieces: str, *, of: str = '', stays: bool = False,
        clock: Callable[[], float] = time.monotonic) -> Progress | None:
    """
    Return a function that shows the finished pieces, time spent and time left; None: no terminal.

    ``pieces`` is their plural; ``of`` the whole that they are part of. At the end the line is
    erased, unless it ``stays``.
    """
    line = terminal_line(stream)
    if line is None:
        return None
    start = clock()

    def report(done: int, total: int, what: str = '') -> None:
        spent = clock() - start
        text = f'{of}{": " if of else ""}{done} of {total} {pieces}, {spent:.0f} s'
        if done < total:
            left = f', {spent / done * (total - done):.0f} s left' if done else ''
            line.show(f'{text}{left}{": " if what else ""}{what}')
        elif stays:
            line.end(text)
        else:
            line.erase()
    return report
