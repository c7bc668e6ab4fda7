"""
Draw the imports between packages of isa_ros: `python scripts/draw_imports.py [FILE.svg]`.

The rows are the layers of the import contract in pyproject.toml; the width of an arrow grows with
the number of importing modules, which its title shows. The default file is
docs/figures/imports.svg.
"""

import ast
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
import re
import sys

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / 'isa_ros'
PICTURE = ROOT / 'docs' / 'figures' / 'imports.svg'
EVERYWHERE = ('core', 'errors')
"""Packages that nearly all others import; their arrows are left out."""

WIDTH, ROW, BOX_HEIGHT, LETTER, PADDING = 860, 62, 30, 8.2, 14
STAGGER = (0.5, 0.22, 0.78)     # positions of single packages, row by row, over the width

Edge = tuple[str, str]


def layers() -> list[list[str]]:
    """Return the packages of each layer of the contract, from the top down."""
    text = (ROOT / 'pyproject.toml').read_text(encoding='utf-8')
    listed = re.search(r'^layers = \[\n(.*?)^\]', text, re.MULTILINE | re.DOTALL)
    assert listed is not None, 'pyproject.toml has a layers contract'
    return [line.split(' | ') for line in re.findall(r'"([^"]+)"', listed[1])]


def imports() -> Counter[Edge]:
    """Return how many modules of one package import from another."""
    edges: Counter[Edge] = Counter()
    for path in sorted(PACKAGE.rglob('*.py')):
        if path == PACKAGE / '__init__.py':
            continue  # it imports the public names lazily
        own = _package(path.relative_to(PACKAGE).parts[0])
        others = {_package(name.split('.')[1]) for name in _imported(path) if '.' in name}
        edges.update((own, other) for other in others if other != own)
    return edges


def _package(part: str) -> str:
    return part.removesuffix('.py')


def _imported(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
        if isinstance(node, ast.ImportFrom) and (node.module or '').startswith('isa_ros'):
            if node.module == 'isa_ros':
                yield from (f'isa_ros.{alias.name}' for alias in node.names
                            if (PACKAGE / alias.name).exists())
            elif node.module is not None:
                yield node.module


def places(rows: list[list[str]]) -> dict[str, tuple[float, float]]:
    """Return the middle of every package's box."""
    found = {}
    for k, names in enumerate(rows):
        for n, name in enumerate(names):
            share = STAGGER[k % len(STAGGER)] if len(names) == 1 else (n + 0.5) / len(names)
            found[name] = (WIDTH * share, ROW * (k + 0.5))
    return found


def picture() -> str:
    """Return the drawing as SVG."""
    rows = [names for names in layers() if names != ['__main__']]
    at, height = places(rows), ROW * len(rows)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
        'font-family="sans-serif" font-size="14" text-anchor="middle">',
        f'<rect width="{WIDTH}" height="{height}" fill="white"/>',
        '<marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" '
        'orient="auto"><path d="M0,0 L8,4 L0,8 z" fill="#6b87a8"/></marker>']
    for (upper, lower), count in sorted(imports().items()):
        if lower in EVERYWHERE or upper not in at or lower not in at:
            continue
        (x_0, y_0), (x_1, y_1) = at[upper], at[lower]
        y_0, y_1 = y_0 + 0.5 * BOX_HEIGHT, y_1 - 0.5 * BOX_HEIGHT
        bend = 0.5 * (y_1 - y_0)
        lines.append(
            f'<path d="M{x_0:.0f},{y_0:.0f} C{x_0:.0f},{y_0 + bend:.0f} '
            f'{x_1:.0f},{y_1 - bend:.0f} {x_1:.0f},{y_1:.0f}" fill="none" stroke="#6b87a8" '
            f'stroke-width="{0.6 + 0.12 * min(count, 20):.2f}" stroke-opacity="0.65" '
            f'marker-end="url(#tip)"><title>{upper} imports {lower}: {count} modules</title>'
            '</path>')
    for name, (x, y) in at.items():
        width = LETTER * len(name) + 2 * PADDING
        lines.append(
            f'<rect x="{x - 0.5 * width:.0f}" y="{y - 0.5 * BOX_HEIGHT:.0f}" '
            f'width="{width:.0f}" height="{BOX_HEIGHT}" rx="5" fill="#eef3f8" '
            'stroke="#35506e"/>')
        lines.append(f'<text x="{x:.0f}" y="{y + 5:.0f}">{name}</text>')
    return '\n'.join([*lines, '</svg>', ''])


def main() -> None:
    """Write the drawing."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else PICTURE
    path.write_text(picture(), encoding='utf-8')
    print(path)


if __name__ == '__main__':
    main()
