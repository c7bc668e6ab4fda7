"""docs/architecture.md names what there is, and its picture is of today's imports."""

from pathlib import Path
import re

from scripts import draw_imports

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / 'docs' / 'architecture.md').read_text(encoding='utf-8')


def test_the_picture_is_the_one_the_script_draws() -> None:
    """`python scripts/draw_imports.py` after a change of the imports."""
    assert draw_imports.PICTURE.read_text(encoding='utf-8') == draw_imports.picture()


def test_every_arrow_of_the_picture_points_down() -> None:
    row = {name: k for k, names in enumerate(draw_imports.layers()) for name in names}
    edges = draw_imports.imports()
    assert edges['run', 'bag'] > 0  # it does see imports
    for upper, lower in edges:
        assert row[upper] < row[lower], (upper, lower)


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
