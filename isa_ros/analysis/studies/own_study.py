"""A study with a rig of its own: as text, as JSON, and as a page."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Generic, TypeVar

from isa_ros.core.frozen import frozen
from isa_ros.text.page import Page
from isa_ros.text.progress import Progress
from isa_ros.text.table import aligned, Cells, RIGHT

_Found = TypeVar('_Found')


@frozen
class OwnStudy(Generic[_Found]):
    """A study that no parameter of one actuator is varied for, with measures of its own."""

    name: str
    """Its page is NAME.md."""
    title: str
    results: Callable[[Progress | None], _Found]
    """Runs it."""
    table: Callable[[_Found], Sequence[Cells]]
    """What a terminal shows, its header first."""
    numbers: Callable[[_Found], dict[str, Any]]
    """What JSON has beside name and title."""
    head: str
    """Of the page."""
    fill: Callable[[Page, _Found], None]
    """Adds all else to the page."""
    sides: str = RIGHT
    """Of the table, as in `isa_ros.text.table`."""

    def as_text(self, found: _Found) -> str:
        """Return the text for a terminal."""
        return '\n'.join([self.title, *aligned(self.table(found), self.sides)])

    def as_tree(self, found: _Found) -> dict[str, Any]:
        """Return the study for JSON."""
        return {'name': self.name, 'title': self.title, **self.numbers(found)}

    def write_page(self, found: _Found, directory: Path) -> list[Path]:
        """Write the page and its figures into a directory; return their paths."""
        page = Page(f'{self.name}.md', self.head)
        self.fill(page, found)
        return page.write(directory)
