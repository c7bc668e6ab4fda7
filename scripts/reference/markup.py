"""Texts of the code as Markdown."""

from collections.abc import Sequence
import inspect
import re

WRITTEN = '% Written by `python -m scripts.write_reference`; do not edit.'
"""First line of a page, which is not shown."""
_UNDERLINED = re.compile(r'^(\w[\w ]*)\n-{3,}\n', re.MULTILINE)
_CODE = re.compile(r'``([^`]+)``')


def page(title: str, *paragraphs: str) -> str:
    """Return a page of paragraphs, without those that are empty."""
    return '\n\n'.join([WRITTEN, f'# {title}', *filter(None, paragraphs)]) + '\n'


def escaped(text: str) -> str:
    """Return a text of one line in which Markdown finds no tags, emphasis or cells."""
    return ' '.join(text.split()).replace('&', '&amp;').replace('<', '&lt;').replace(
        '*', r'\*').replace('|', 'or')


def code(text: str) -> str:
    """Return a text as code; '' for an empty one."""
    return f'`{text}`' if text else ''


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table; the cells are Markdown."""
    lines = [header, ['---'] * len(header), *rows]
    return '\n'.join(f'| {" | ".join(cells)} |' for cells in lines)


def docstring(text: str) -> str:
    """Return a docstring as Markdown: headings of its parts in bold, code in single quotes."""
    clean = inspect.cleandoc(text)
    return _CODE.sub(r'`\1`', _UNDERLINED.sub(r'**\1**\n\n', clean)).replace('::\n', ':\n')
