"""The table of what a master sees, collected from the tests that assert its rows."""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple


class Row(NamedTuple):
    """One row of the table."""

    event: str
    seen: str
    recovery: str
    module: str
    """Of the test, the order of the table."""


ROWS: dict[str, Row] = {}
"""By name of the test."""


def row(event: str, seen: str, recovery: str = '') -> Callable[[Any], Any]:
    """Note the row that a test asserts."""
    def note(test: Any) -> Any:
        ROWS[test.__name__] = Row(event, seen, recovery, test.__module__)
        return test
    return note


def table() -> Iterator[str]:
    """Yield the lines of the table in docs/ethercat.md."""
    yield '| what happens | what a master sees | what it does then |'
    yield '|---|---|---|'
    for one in sorted(ROWS.values(), key=lambda one: one.module):
        yield f'| {one.event} | {one.seen} | {one.recovery} |'
