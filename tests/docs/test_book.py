"""The book: each page is in its tree once, and Sphinx makes it without a warning."""

from collections import Counter
from pathlib import Path
import re

import pytest
from scripts import build_docs
from tests.garbage import uncollected

DOCS = build_docs.SOURCE
_TREE = re.compile(r'^```\{toctree\}\n(.*?)^```$', re.MULTILINE | re.DOTALL)
_LINK = re.compile(r'\]\((?!https?:|#)([^)#\s]+)')


def entries(page: Path) -> list[Path]:
    """Return the pages that the trees of a page name."""
    trees = _TREE.findall(page.read_text(encoding='utf-8'))
    return [(page.parent / f'{line}.md').resolve() for tree in trees
            for line in tree.split('\n') if line and not line.startswith(':')]


def test_every_page_is_in_the_tree_once() -> None:
    """Beginning at the index; a page that is not is found by nobody."""
    found, open_ = Counter([DOCS / 'index.md']), [DOCS / 'index.md']
    while open_:
        below = entries(open_.pop())
        found.update(below)
        open_ += below
    assert set(found) == set(DOCS.rglob('*.md'))
    assert [page for page, times in found.items() if times > 1] == []


@pytest.mark.parametrize('page', ['index', 'how_to', 'reference', 'explanation'])
def test_a_page_of_the_tree_says_what_is_below_it(page: str) -> None:
    """Its table has a link to each page of its tree, so that nobody needs the sidebar."""
    own = DOCS / f'{page}.md'
    linked = {(own.parent / link).resolve() for link in _LINK.findall(own.read_text())}
    assert set(entries(own)) - linked <= {DOCS / 'licences.md'}


@pytest.mark.slow
@pytest.mark.skipif(bool(build_docs.missing()), reason=build_docs.missing())
def test_the_book_is_made_without_a_warning_and_loads_nothing(tmp_path: Path) -> None:
    with uncollected():     # a fifth faster
        assert build_docs.main([str(tmp_path)]) == 0
    for page in DOCS.rglob('*.md'):
        made = tmp_path / page.relative_to(DOCS).with_suffix('.html')
        assert '<h1>' in made.read_text(encoding='utf-8'), made
    assert 'Sphinx' in (tmp_path / 'index.html').read_text(encoding='utf-8')
    assert build_docs.loaded_from_elsewhere(tmp_path) == []


@pytest.mark.slow
@pytest.mark.skipif(bool(build_docs.missing()), reason=build_docs.missing())
def test_a_link_to_nowhere_is_an_error(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = tmp_path / 'docs'
    source.mkdir()
    (source / 'conf.py').write_text((DOCS / 'conf.py').read_text().replace(
        'Path(__file__).parents[1]', f'Path({str(build_docs.ROOT)!r})'))
    (source / 'index.md').write_text('# A page\n\n[none](none.md)\n')
    monkeypatch.setattr(build_docs, 'SOURCE', source)
    assert build_docs.main([str(tmp_path / 'out')]) != 0


def test_without_sphinx_one_line_says_what_is_needed(
        monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(build_docs, 'find_spec', lambda name: None if name == 'furo' else 1)
    assert build_docs.main([]) == 2
    assert capsys.readouterr().err == (
        'build_docs: furo not installed: requirements-docs.txt\n')


def test_what_a_page_loads_is_found(tmp_path: Path) -> None:
    (tmp_path / 'a.html').write_text(
        '<a href="https://a.org">a</a><script async src="https://b.org/x.js"></script>'
        '<link rel="stylesheet" href="//c.org/y.css"><img src="own.png"/>'
        '<link href="own.css"/>')
    (tmp_path / 'b.css').write_text('@import "https://d.org/z.css"; a {src: url(own.woff)}')
    assert build_docs.loaded_from_elsewhere(tmp_path) == [
        'a.html: //c.org/y.css', 'a.html: https://b.org/x.js', 'b.css: https://d.org/z.css']
