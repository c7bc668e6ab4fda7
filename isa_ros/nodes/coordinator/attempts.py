"""Requests of services that may be refused."""

from collections.abc import Callable
from typing import NamedTuple

from isa_ros.errors import IsaError

LARGEST_STEP = 1_000_000_000
"""Ticks of one request."""


class Attempt(NamedTuple):
    """Whether a request was done, and what to answer."""

    is_done: bool
    message: str


def attempted(request: Callable[[], str]) -> Attempt:
    """
    Do a request, which returns its answer, and return the outcome.

    Raises
    ------
    IsaError
        The run itself has failed, as its exit code says: it must not go on.

    """
    try:
        return Attempt(True, request())
    except IsaError as error:
        if error.exit_code != IsaError.exit_code:
            raise
        return Attempt(False, str(error))
