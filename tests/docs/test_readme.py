"""The README is short, runs as printed, and leads to what is there."""

from pathlib import Path
import re

import pytest
from tests.docs.blocks import blocks_of, first_line, run
from tests.docs.pages import ROOT
from tests.ros.domains import held_domain

README = (ROOT / 'README.md').read_text(encoding='utf-8')
MOST_LINES = 150
NOT_RUN = ('./isa demo', 'smart_manifold', 'ros2 topic echo /smart_manifold/joint_states')
"""First lines of indented commands: of the whole suite, and of two terminals."""


def test_it_is_for_the_first_five_minutes() -> None:
    assert len(README.splitlines()) <= MOST_LINES


@pytest.mark.slow
@pytest.mark.ros
def test_its_blocks_run_as_printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with held_domain(monkeypatch):
        assert run(README, tmp_path, NOT_RUN) == 2


def test_commands_that_are_not_run_are_indented_ones() -> None:
    commands = [block for block in blocks_of(README) if block.kind == 'command']
    assert [first_line(block) for block in commands] == list(NOT_RUN)


def test_every_file_it_links_to_is_there() -> None:
    links = set(re.findall(r'\]\((?!http|#)([^)#]+)', README))
    assert len(links) > 25
    assert [link for link in links if not (ROOT / link).exists()] == []
