"""What every door promises: accepted and well defined, or refused in one clear line."""

from collections.abc import Callable

from isa_ros.errors import IsaError, one_line

LONGEST = 4000  # characters of a message before it is shortened for the terminal


class Broken(AssertionError):
    """An input for which a door does not keep its promise."""


def refused(attempt: Callable[[], object], case: str) -> bool:
    """Return whether an input was refused; raise `Broken` for any other error, naming the case."""
    try:
        attempt()
    except IsaError as error:
        text = str(error)
        if not text.strip() or '\n' in one_line(text):
            raise Broken(f'{case}: the message is {text!r}') from error
        return True
    except Exception as error:
        raise Broken(f'{case}: {type(error).__name__}: {error}') from error
    return False
