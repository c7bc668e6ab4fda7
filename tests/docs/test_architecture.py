"""docs/architecture.md names what there is, and its picture is of today's imports."""

from collections.abc import Mapping
from pathlib import Path
import re

import pytest
from scripts import draw_imports

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / 'docs' / 'architecture.md').read_text(encoding='utf-8')


@pytest.mark.parametrize('folder', draw_imports.DRAWN)
def test_each_picture_is_the_one_the_script_draws(folder: str) -> None:
    """`python scripts/draw_imports.py` after a change of the imports."""
    picture = draw_imports.drawing(folder)
    assert picture.read_text(encoding='utf-8') == draw_imports.picture(folder)
    assert f'](figures/{picture.name})' in PAGE


def test_every_arrow_of_the_picture_points_down() -> None:
    row = {name: k for k, names in enumerate(draw_imports.layers()) for name in names}
    edges = draw_imports.imports()
    assert edges['run', 'bag'] > 0  # it does see imports
    for upper, lower in edges:
        if upper in row and lower in row:  # not the public names, and the folders beside
            assert row[upper] < row[lower], (upper, lower)
    assert draw_imports.counts(draw_imports.WHOLE)['upward arrows'] == 0


@pytest.mark.parametrize('folder', draw_imports.DRAWN)
def test_no_rooms_import_each_other_in_a_circle(folder: str) -> None:
    found = draw_imports.counts(folder)
    assert (found['circles'], found['upward arrows']) == (0, 0)


def tree(root: Path, modules: Mapping[str, str]) -> Path:
    """Write modules below ``root``, by path without ``.py``."""
    for name, text in modules.items():
        path = root / f'{name}.py'
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return root


def test_rooms_floors_arrows_and_circles_are_counted(tmp_path: Path) -> None:
    """Two packages that import each other, with a module above them and one below."""
    root = tree(tmp_path, {
        'isa_ros/f/top': 'from isa_ros.f.a.one import x\nfrom isa_ros.f.a import two',
        'isa_ros/f/a/one': 'import isa_ros.f.b.three', 'isa_ros/f/a/two': '',
        'isa_ros/f/b/three': 'from isa_ros.f.low import y', 'isa_ros/f/low': 'import os',
        'isa_ros/f/b/four': 'def f():\n    from ..a import two', 'isa_ros/other': ''})
    assert draw_imports.imports('isa_ros/f', root) == {
        ('top', 'a'): 1, ('a', 'b'): 1, ('b', 'low'): 1, ('b', 'a'): 1}
    assert draw_imports.floors('isa_ros/f', root) == [['top'], ['a', 'b'], ['low']]
    assert draw_imports.counts('isa_ros/f', root) == {
        'rooms': 4, 'floors': 3, 'arrows': 4, 'circles': 1, 'circles of modules': 0,
        'upward arrows': 2}


def test_an_arrow_that_others_make_up_is_not_drawn() -> None:
    """Over one room or over two; two ways to one room are both drawn."""
    edges = [('a', 'b'), ('b', 'c'), ('c', 'd'), ('a', 'c'), ('a', 'd'), ('a', 'e'), ('e', 'd')]
    assert draw_imports.reduced(edges) == [
        ('a', 'b'), ('a', 'e'), ('b', 'c'), ('c', 'd'), ('e', 'd')]
    drawn = draw_imports.picture().count('<path d="M') - 1      # the tip is one
    assert 20 < drawn < len(draw_imports.imports()) / 2
    assert '<title>text imports core (' in draw_imports.picture()


def test_an_init_is_a_room_where_it_imports(tmp_path: Path) -> None:
    root = tree(tmp_path, {
        'isa_ros/__init__': 'from isa_ros.f import g', 'isa_ros/f/__init__': '',
        'isa_ros/f/g': '', 'scripts/s': 'from isa_ros.f import g'})
    assert draw_imports.rooms('isa_ros/f', root) == {'g'}
    assert draw_imports.rooms('isa_ros', root) == {'__init__', 'f', 'scripts'}


def test_every_package_is_in_the_table() -> None:
    named = set(re.findall(r'`(\w+)`', ''.join(
        line.split('|')[1] for line in PAGE.splitlines() if line.startswith('| `'))))
    layers = {name for names in draw_imports.layers() for name in names}
    assert layers - {'__main__', 'errors'} <= named


def test_every_path_it_names_exists() -> None:
    paths = set(re.findall(r'`((?:[a-z_]+/)+[a-z_]+(?:\.py)?)`', PAGE))
    assert len(paths) > 20
    for path in paths:
        assert (ROOT / path).exists() or (ROOT / 'isa_ros' / path).exists(), path
