"""
Write the lessons of docs/ as Jupyter notebooks without outputs.

    python -m scripts.write_notebooks [DIR]

DIR is build/notebooks if it is not given. A lesson is a page of the book: its text is Markdown, so
that changes can be read and links are checked, and its blocks are run by the tests as printed. In
a notebook Python blocks are cells, commands are cells that run this environment's isa_ros, what a
block prints is left out, and links lead to the pages.
"""

from collections.abc import Iterator, Sequence
import json
import os
from pathlib import Path
import re
import sys
from typing import Any

from isa_ros.core.atomic_file import replace_file

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / 'docs'
LESSONS = 'lesson_pressure', 'lesson_valve', 'lesson_tuning'
Cell = dict[str, Any]
_PARTS = re.compile(r'^```(\w+)\n(.*?)^```\n', re.MULTILINE | re.DOTALL)
_FIGURE = re.compile(r'^!\[[^]]*\]\([^)]*\)\n', re.MULTILINE)
_LINK = re.compile(r'\]\((?!https?:|#)([^)\s]+)\)')
_COMMAND = re.compile(r'^\./isa ', re.MULTILINE)


def notebook(page: str, links: str) -> dict[str, Any]:
    """
    Return a page as a notebook of format 4.5.

    ``links`` is the way from the notebook to the folder of the page.
    """
    cells = [{'id': f'cell-{number}', **cell} for number, cell in enumerate(_cells(page, links))]
    return {
        'cells': cells, 'nbformat': 4, 'nbformat_minor': 5, 'metadata': {
            'kernelspec': {'display_name': 'Python 3', 'language': 'python', 'name': 'python3'},
            'language_info': {'name': 'python'}}}


def _cells(page: str, links: str) -> Iterator[Cell]:
    """Yield text, Python, commands; of ``re.split``: text, kind, content, text, ..."""
    parts = _PARTS.split(page)
    for text, kind, content in zip(parts[::3], [*parts[1::3], ''], [*parts[2::3], '']):
        words = _LINK.sub(rf']({links}/\1)', _FIGURE.sub('', text)).strip()
        if words:
            yield {'cell_type': 'markdown', 'metadata': {}, 'source': words}
        if kind == 'bash':
            yield _code('import sys\n' + _COMMAND.sub('!{sys.executable} -m isa_ros ', content))
        elif kind == 'python':
            yield _code(content)


def _code(source: str) -> Cell:
    return {'cell_type': 'code', 'metadata': {}, 'execution_count': None, 'outputs': [],
            'source': source.rstrip('\n')}


def write(name: str, out: Path) -> Path:
    """Write a lesson to a directory; return its notebook."""
    page = (DOCS / f'{name}.md').read_text(encoding='utf-8')
    made = notebook(page, Path(os.path.relpath(DOCS, out)).as_posix())
    path = out / f'{name}.ipynb'
    replace_file(path, (json.dumps(made, indent=1) + '\n').encode(), is_durable=False)
    return path


def main(arguments: Sequence[str]) -> int:
    """Write all lessons; print where they are."""
    out = Path(arguments[0]) if arguments else ROOT / 'build' / 'notebooks'
    out.mkdir(parents=True, exist_ok=True)
    for name in LESSONS:
        print(write(name, out))
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
