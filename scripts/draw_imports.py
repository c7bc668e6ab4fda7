"""
Draw and count the imports between packages of isa_ros, and between the rooms of a folder.

    python scripts/draw_imports.py                      # writes docs/figures/imports*.svg
    python scripts/draw_imports.py --count [FOLDER]     # isa_ros, isa_ros/fieldbus, ...

A *room* of a folder is a module or package directly in it; `__init__` is one where it imports
something. Rooms of the whole, isa_ros, are also msg_adapters, scripts and launch. An *arrow* is a
room that imports from another one, however often. The *floors* are the rooms of the longest way
down, where rooms that import each other in a circle are on one floor. *Circles* are counted
between rooms, and between all modules of the folder. An arrow points *upward* if the layers of
the import contract in pyproject.toml forbid it; within a folder, if it is part of a circle.

In the drawing of the whole, the rows are those layers; in others, the floors. An arrow that others
make up is left out, so that a room imports from rooms that it reaches only; which, and in how many
modules, is in the title of its box.
"""

import ast
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
import re
import sys

ROOT = Path(__file__).resolve().parents[1]
WHOLE = 'isa_ros'
BESIDES = ('msg_adapters', 'scripts', 'launch')
"""Folders beside isa_ros that are rooms of the whole."""
EVERYWHERE = ('core', 'errors')
"""Packages that nearly all others import; their arrows are left out of the drawing."""
DRAWN = {WHOLE: 'imports.svg', 'isa_ros/fieldbus': 'imports_fieldbus.svg',
         'isa_ros/config': 'imports_config.svg'}
"""Folders with a drawing in docs/figures."""

WIDTH, ROW, BOX_HEIGHT, LETTER, PADDING = 860, 62, 30, 8.2, 14
STAGGER = (0.5, 0.22, 0.78)     # positions of single packages, row by row, over the width

Edge = tuple[str, str]


def layers() -> list[list[str]]:
    """Return the packages of each layer of the contract, from the top down."""
    text = (ROOT / 'pyproject.toml').read_text(encoding='utf-8')
    listed = re.search(r'^layers = \[\n(.*?)^\]', text, re.MULTILINE | re.DOTALL)
    assert listed is not None, 'pyproject.toml has a layers contract'
    return [line.split(' | ') for line in re.findall(r'"([^"]+)"', listed[1])]


@cache
def module_imports(root: Path = ROOT) -> dict[str, frozenset[str]]:
    """Return what each module of the package, and of the folders beside it, imports of them."""
    modules = {'.'.join(path.relative_to(root).with_suffix('').parts): path
               for top in (WHOLE, *BESIDES) for path in sorted((root / top).rglob('*.py'))}
    return {name: frozenset(_imported(name, path, modules)) - {name}
            for name, path in modules.items()}


def _imported(module: str, path: Path, modules: Iterable[str]) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            package = '.'.join(module.split('.')[:-node.level]) if node.level else ''
            names = [f'{package}.{node.module or ""}'.strip('.') + f'.{alias.name}'
                     for alias in node.names]
        else:
            continue
        for name in names:
            while name and name not in modules and f'{name}.__init__' not in modules:
                name = name.rpartition('.')[0]
            if name:
                yield name if name in modules else f'{name}.__init__'


def _room(module: str, folder: str) -> str | None:
    """Return the room of a module; None: it is not in the folder."""
    inside, name = folder.replace('/', '.') + '.', module.partition('.')[0]
    if module.startswith(inside):
        return module[len(inside):].partition('.')[0]
    return name if folder == WHOLE and name in BESIDES else None


def imports(folder: str = WHOLE, root: Path = ROOT) -> Counter[Edge]:
    """Return how many modules of one room of a folder import from another."""
    edges: Counter[Edge] = Counter()
    for module, imported in module_imports(root).items():
        own = _room(module, folder)
        others = {_room(other, folder) for other in imported} - {own, None}
        edges.update((own, other) for other in others if own is not None and other is not None)
    return edges


def rooms(folder: str, root: Path = ROOT) -> set[str]:
    """Return the rooms of a folder."""
    found = {_room(module, folder) for module in module_imports(root)}
    importing = {edge[0] for edge in imports(folder, root)}
    return {room for room in found
            if room is not None and (room != '__init__' or room in importing)}


def reached(edges: Iterable[Edge]) -> dict[str, set[str]]:
    """Return what each name reaches by arrows, itself only where it is on a circle."""
    following: dict[str, set[str]] = {}
    for one, other in edges:
        following.setdefault(one, set()).add(other)
    found = {}
    for name in following:
        seen: set[str] = set()
        waiting = [name]
        while waiting:
            new = following.get(waiting.pop(), set()) - seen
            seen |= new
            waiting += new
        found[name] = seen
    return found


def circles(edges: Iterable[Edge]) -> set[frozenset[str]]:
    """Return the groups of names that import each other, directly or not."""
    ways = reached(edges)
    return {frozenset(other for other in found if name in ways.get(other, ()))
            for name, found in ways.items() if name in found}


def reduced(edges: Iterable[Edge]) -> list[Edge]:
    """Return the arrows that no way over another room makes up, sorted; without circles."""
    edges = set(edges)
    ways = reached(edges)
    return sorted(edge for edge in edges if not any(
        (edge[0], other) in edges and edge[1] in ways.get(other, ())
        for other in ways[edge[0]] - {edge[1]}))


def floors(folder: str, root: Path = ROOT) -> list[list[str]]:
    """Return the rooms of a folder by floor, from the top down, each below all that import it."""
    names, edges = rooms(folder, root), set(imports(folder, root))
    alike = {name: group for group in circles(edges) for name in group}
    groups = {alike.get(name, frozenset((name,))) for name in names}

    @cache
    def height(group: frozenset[str]) -> int:
        below = {alike.get(other, frozenset((other,))) for one, other in edges if one in group}
        return 1 + max(map(height, below - {group}), default=0)

    found: list[list[str]] = [[] for _ in range(max(map(height, groups)))]
    for group in groups:
        found[-height(group)] += group
    return [sorted(floor) for floor in found]


def counts(folder: str, root: Path = ROOT) -> dict[str, int]:
    """Return the figures of a folder."""
    edges = set(imports(folder, root))
    modules = {(module, other) for module, imported in module_imports(root).items()
               for other in imported if _room(module, folder) and _room(other, folder)}
    around = circles(edges)
    row = {name: k for k, names in enumerate(layers()) for name in names}
    upward = [edge for edge in edges if (
        edge[0] in row and edge[1] in row and row[edge[0]] >= row[edge[1]] if folder == WHOLE
        else any(edge[0] in group and edge[1] in group for group in around))]
    return {'rooms': len(rooms(folder, root)), 'floors': len(floors(folder, root)),
            'arrows': len(edges), 'circles': len(around),
            'circles of modules': len(circles(modules)), 'upward arrows': len(upward)}


def places(rows: list[list[str]]) -> dict[str, tuple[float, float]]:
    """Return the middle of every room's box."""
    found = {}
    for k, names in enumerate(rows):
        for n, name in enumerate(names):
            share = STAGGER[k % len(STAGGER)] if len(names) == 1 else (n + 0.5) / len(names)
            found[name] = (WIDTH * share, ROW * (k + 0.5))
    return found


def picture(folder: str = WHOLE) -> str:
    """Return the drawing of a folder as SVG."""
    rows = floors(folder) if folder != WHOLE else [
        names for names in layers() if names != ['__main__']]
    at, height = places(rows), ROW * len(rows)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
        'font-family="sans-serif" font-size="14" text-anchor="middle">',
        f'<rect width="{WIDTH}" height="{height}" fill="white"/>',
        '<marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" '
        'orient="auto"><path d="M0,0 L8,4 L0,8 z" fill="#6b87a8"/></marker>']
    found = imports(folder)
    for upper, lower in reduced(
            (upper, lower) for upper, lower in found if upper in at and lower in at
            and not (folder == WHOLE and lower in EVERYWHERE)):
        (x_0, y_0), (x_1, y_1) = at[upper], at[lower]
        y_0, y_1 = y_0 + 0.5 * BOX_HEIGHT, y_1 - 0.5 * BOX_HEIGHT
        bend = 0.5 * (y_1 - y_0)
        lines.append(
            f'<path d="M{x_0:.0f},{y_0:.0f} C{x_0:.0f},{y_0 + bend:.0f} '
            f'{x_1:.0f},{y_1 - bend:.0f} {x_1:.0f},{y_1:.0f}" fill="none" stroke="#6b87a8" '
            'stroke-width="1.6" marker-end="url(#tip)"/>')
    for name, (x, y) in at.items():
        width = LETTER * len(name) + 2 * PADDING
        lines.append(
            f'<rect x="{x - 0.5 * width:.0f}" y="{y - 0.5 * BOX_HEIGHT:.0f}" '
            f'width="{width:.0f}" height="{BOX_HEIGHT}" rx="5" fill="#eef3f8" '
            f'stroke="#35506e"><title>{_title(name, found)}</title></rect>')
        lines.append(f'<text x="{x:.0f}" y="{y + 5:.0f}" pointer-events="none">{name}</text>')
    return '\n'.join([*lines, '</svg>', ''])


def _title(name: str, edges: Mapping[Edge, int]) -> str:
    """Return which rooms a room imports from, and in how many of its modules."""
    below = [f'{lower} ({count})' for (upper, lower), count in sorted(edges.items())
             if upper == name]
    return f'{name} imports {", ".join(below) or "nothing"}'


def drawing(folder: str) -> Path:
    """Return the file of a folder's drawing."""
    return ROOT / 'docs' / 'figures' / DRAWN[folder]


def main() -> None:
    """Write the drawings, or print the figures."""
    if sys.argv[1:2] == ['--count']:
        for folder in sys.argv[2:] or DRAWN:
            print(f'{folder}:', ', '.join(f'{n} {name}' for name, n in counts(folder).items()))
        return
    for folder in DRAWN:
        drawing(folder).write_text(picture(folder), encoding='utf-8')
        print(drawing(folder))


if __name__ == '__main__':
    main()
