"""A Markdown page and its figures, as files."""

import io

from isa_ros.errors import ConfigError
from isa_ros.text.page import COLORS, Page, png, png_with_palette, refuse_a_part
from matplotlib.figure import Figure
import numpy as np
from PIL import Image
import pytest


@pytest.fixture
def figure() -> Figure:
    """Return a figure of more than 64 colors."""
    drawn = Figure(figsize=(3.0, 2.0), dpi=50)
    drawn.subplots().imshow(np.linspace(0.0, 1.0, 400).reshape(20, 20))
    return drawn


def test_paragraphs_are_apart_and_the_page_ends_with_one_line_break(tmp_path):
    page = Page('a.md', '# Title\n\nWhat it is.\n\n')
    page.section('One')
    page.paragraph('')
    page.items([])
    page.table([('', 'value'), ('a', '1')], 'lr')
    page.items(['first', 'second'])
    path, = page.write(tmp_path / 'docs')
    assert path == tmp_path / 'docs' / 'a.md'
    assert path.read_text(encoding='utf-8') == (
        '# Title\n\nWhat it is.\n\n## One\n\n| | value |\n|---|---:|\n| a | 1 |\n\n'
        '- first\n- second\n')
    assert list(path.parent.iterdir()) == [path]


def test_figures_are_written_beside_the_page_that_shows_them(tmp_path):
    page = Page('a.md', '# Title')
    page.figure('step', 'A step.', b'first')
    page.figure('sine', 'A sine.', b'second')
    written = page.write(tmp_path)
    assert [str(path.relative_to(tmp_path)) for path in written] == [
        'a.md', 'figures/step.png', 'figures/sine.png']
    assert [path.read_bytes() for path in written[1:]] == [b'first', b'second']
    assert '![A step.](figures/step.png)\n\n![A sine.]' in written[0].read_text()


def test_the_same_figure_gives_the_same_bytes_without_a_program_s_name(figure):
    drawn = png(figure)
    assert drawn == png(figure) and drawn.startswith(b'\x89PNG') and b'Software' not in drawn


def test_a_palette_keeps_the_size_and_the_bytes_are_fewer(figure):
    small = png_with_palette(figure)
    assert len(small) < len(png(figure)) and b'Software' not in small
    with Image.open(io.BytesIO(png(figure))) as full, Image.open(io.BytesIO(small)) as image:
        assert image.mode == 'P' and image.size == full.size
        colors = image.getcolors()
        assert colors is not None and len(colors) <= COLORS


def test_a_part_does_not_replace_a_page(tmp_path):
    page = tmp_path / 'a.md'
    refuse_a_part(page, ['one'])    # nothing is there yet
    page.touch()
    refuse_a_part(page, None)
    with pytest.raises(ConfigError, match='a.md already exists: --only would keep only a part'):
        refuse_a_part(page, ['one'])
