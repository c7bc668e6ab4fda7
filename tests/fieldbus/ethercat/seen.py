"""The table of what a master sees, collected from the tests that assert its rows."""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple


class Row(NamedTuple):
    """One row of the table."""

    event: str
    seen: str
    recovery: str


ROWS: dict[str, Row] = {}
"""By name of the test."""


def row(event: str, seen: str, recovery: str = '') -> Callable[[Any], Any]:
    """Note the row that a test asserts."""
    def note(test: Any) -> Any:
        ROWS[test.__name__] = Row(event, seen, recovery)
        return test
    return note


def table() -> Iterator[str]:
    """Yield the lines of the table in docs/ethercat.md."""
    yield '| what happens | what a master sees | what it does then |'
    yield '|---|---|---|'
    for one in ROWS.values():
        yield f'| {one.event} | {one.seen} | {one.recovery} |'
