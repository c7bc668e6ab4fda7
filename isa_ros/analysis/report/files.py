"""The files of a report: its page, and each figure as PNG and SVG beside it."""

from collections.abc import Mapping
import io
from pathlib import Path

from isa_ros.analysis.report.document import GENERATOR
from isa_ros.config.text.names import flat
from isa_ros.core.atomic_file import replace_file
from isa_ros.errors import BagError
from matplotlib import rc_context
from matplotlib.figure import Figure

_MARK = 'isa_ros report'
"""In each figure: only a figure of a report is replaced by one."""
_HEAD = 4096        # bytes of a file, within which it is
_METADATA: Mapping[str, dict[str, str | None]] = {
    'png': {'Software': _MARK}, 'svg': {'Creator': _MARK, 'Date': None}}


def refuse_foreign(page: Path, names: list[str]) -> None:
    """
    Refuse, before the work, to replace what is no report and no figure of one.

    Raises
    ------
    BagError
        A file that would be written already exists, and is another's.

    """
    if page.is_dir():
        raise BagError(f'{page}: is a directory, must be the name of the page')
    if page.exists() and not page.is_file():
        raise BagError(f'{page}: is no file, must be the name of the page')
    if page.exists() and GENERATOR.encode() not in _head(page):
        raise BagError(f'{page} already exists and is not a report, so it is not overwritten')
    for name in names:
        for kind in _METADATA:
            path = figure_path(page, name, kind)
            if path.exists() and _MARK.encode() not in _head(path):
                raise BagError(
                    f'{path} already exists and is not a figure of a report, so it is not '
                    'overwritten')


def figure_path(page: Path, name: str, kind: str) -> Path:
    """Return the path of a figure beside its page."""
    return page.with_name(f'{page.stem}_{flat(name)}.{kind}')


def write_files(page: Path, text: str, figures: Mapping[str, Figure]) -> list[Path]:
    """Write a page and its figures; return their paths, the page first."""
    page.parent.mkdir(parents=True, exist_ok=True)
    written = [page]
    for name, figure in figures.items():
        for kind in _METADATA:
            written.append(figure_path(page, name, kind))
            replace_file(written[-1], image(figure, kind), is_durable=False)
    replace_file(page, text.encode(), is_durable=False)
    return written


def image(figure: Figure, kind: str) -> bytes:
    """
    Return a figure as PNG or SVG; equal bytes for the same figure and version.

    The figure stays as it is laid out now: that takes half of the time of a file.
    """
    into = io.BytesIO()
    with rc_context({
            'svg.hashsalt': _MARK, 'svg.fonttype': 'none', 'figure.autolayout': False,
            'figure.constrained_layout.use': False}):
        figure.savefig(into, format=kind, metadata=_METADATA[kind])
        figure.set_layout_engine(None)
    return into.getvalue()


def _head(path: Path) -> bytes:
    with path.open('rb') as file:
        return file.read(_HEAD)
