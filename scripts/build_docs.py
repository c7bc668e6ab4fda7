"""
Make the book of docs/ as pages of HTML, from the repository alone.

    python -m scripts.build_docs [DIR]

DIR is build/docs if it is not given. Every warning is an error. Needs requirements-docs.txt.
"""

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
import re
import sys

ROOT = Path(__file__).resolve().parents[1]
SOURCE, REQUIREMENTS = ROOT / 'docs', 'requirements-docs.txt'
NEEDED = 'sphinx', 'myst_parser', 'furo'
_LOADED = re.compile(
    r'<(?:script|img|iframe|source)\b[^>]*?\bsrc="([^"]*)"'
    r'|<link\b[^>]*?\bhref="([^"]*)"|(?:url\(|@import )["\']?([^"\')\s]+)')


def missing() -> str:
    """Return what is needed and not installed, in a line; '' if nothing is."""
    absent = [name for name in NEEDED if find_spec(name) is None]
    return f'{", ".join(absent)} not installed: {REQUIREMENTS}' if absent else ''


def build(out: Path) -> int:
    """Make the pages in a directory; return the exit code of Sphinx."""
    from sphinx.cmd.build import build_main
    return build_main(['-W', '--keep-going', '-q', '-E', '-b', 'html', '-d',
                       str(out / '.doctrees'), str(SOURCE), str(out)])


def loaded_from_elsewhere(out: Path) -> list[str]:
    """Return what pages and styles would load from other hosts when they are shown."""
    found = set()
    for path in sorted([*out.rglob('*.html'), *out.rglob('*.css')]):
        for groups in _LOADED.findall(path.read_text(encoding='utf-8')):
            found |= {f'{path.relative_to(out)}: {name}' for name in groups
                      if name.startswith(('http:', 'https:', '//'))}
    return sorted(found)


def main(arguments: Sequence[str]) -> int:
    """Make the book; print where it is, or why it is not made."""
    if reason := missing():
        print(f'build_docs: {reason}', file=sys.stderr)
        return 2
    out = Path(arguments[0]) if arguments else ROOT / 'build' / 'docs'
    if code := build(out):
        return code
    print(out / 'index.html')
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
