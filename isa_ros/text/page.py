"""A page in Markdown and the figures on it, written into one directory."""

from collections.abc import Iterable, Sequence
import io
from pathlib import Path
from typing import Any

from isa_ros.core.atomic_file import replace_file
from isa_ros.errors import ConfigError
from isa_ros.text.table import Cells, LEFT, markdown
from matplotlib.figure import Figure
from PIL import Image

FIGURES = 'figures'     # directory of the figures, beside the page
COLORS = 64             # in a figure with a palette


class Page:
    """A page in memory: paragraphs separated by an empty line, and figures."""

    def __init__(self, file_name: str, head: str) -> None:
        self._file_name = file_name
        self._paragraphs = [head.strip('\n')]
        self._figures: dict[str, bytes] = {}

    def section(self, title: str) -> None:
        """Begin a section."""
        self.paragraph(f'## {title}')

    def paragraph(self, text: str) -> None:
        """Add a paragraph; an empty one is ignored."""
        if text:
            self._paragraphs.append(text)

    def items(self, texts: Iterable[str]) -> None:
        """Add a list."""
        self.paragraph('\n'.join(f'- {text}' for text in texts))

    def table(self, rows: Sequence[Cells], sides: str = LEFT) -> None:
        """Add a table, its header first; ``sides`` as in `isa_ros.text.table`."""
        self.paragraph('\n'.join(markdown(rows, sides)))

    def figure(self, name: str, caption: str, drawn: bytes) -> None:
        """Add a figure, PNG; its file is figures/NAME.png."""
        path = f'{FIGURES}/{name}.png'
        self._figures[path] = drawn
        self.paragraph(f'![{caption}]({path})')

    def write(self, directory: Path) -> list[Path]:
        """Write the page and its figures into a directory; return their paths, the page first."""
        (directory / FIGURES if self._figures else directory).mkdir(parents=True, exist_ok=True)
        for path, drawn in self._figures.items():
            replace_file(directory / path, drawn, is_durable=False)
        page = directory / self._file_name
        text = '\n\n'.join(self._paragraphs) + '\n'
        replace_file(page, text.encode(), is_durable=False)
        return [page, *(directory / path for path in self._figures)]


def png(figure: Figure) -> bytes:
    """Return a figure as PNG; equal bytes for the same figure and version of matplotlib."""
    drawn = io.BytesIO()
    figure.savefig(drawn, format='png', metadata={'Software': None})
    return drawn.getvalue()


def png_with_palette(figure: Figure) -> bytes:
    """Return a figure as PNG of at most `COLORS` colors: a third of the bytes of `png`."""
    small = io.BytesIO()
    with Image.open(io.BytesIO(png(figure))) as image:
        image.convert('RGB').quantize(COLORS, dither=Image.Dither.NONE).save(
            small, format='png', optimize=True)
    return small.getvalue()


def write_wanted_page(form: Any, found: Any, directory: Path | None) -> None:
    """Write the page of a result by its module and print the paths; do nothing without a path."""
    if directory is not None:
        for path in form.write_page(found, directory):
            print(path)


def refuse_a_part(page: Path, only: Sequence[str] | None) -> None:
    """
    Refuse to replace a page by the parts of it selected with ``--only``.

    Raises
    ------
    ConfigError
        The page already exists, and ``only`` selects parts of it.

    """
    if only and page.exists():
        raise ConfigError(f'{page} already exists: --only would keep only a part of it')
