"""The README is short, runs as printed, and leads to what is there."""

from pathlib import Path
import re

import pytest
from tests.docs.blocks import run
from tests.docs.pages import ROOT
from tests.ros.domains import held_domain

README = (ROOT / 'README.md').read_text(encoding='utf-8')
MOST_LINES = 150


def test_it_is_for_the_first_five_minutes() -> None:
    assert len(README.splitlines()) <= MOST_LINES


@pytest.mark.slow
@pytest.mark.ros
def test_its_blocks_run_as_printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with held_domain(monkeypatch):
        assert run(README, tmp_path) == 2


def test_every_file_it_links_to_is_there() -> None:
    links = set(re.findall(r'\]\((?!http|#)([^)#]+)', README))
    assert len(links) > 25
    assert [link for link in links if not (ROOT / link).exists()] == []
