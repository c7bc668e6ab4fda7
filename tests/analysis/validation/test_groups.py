"""The shipped groups: each entry is reached or has a reason, and its references exist."""

from pathlib import Path
import re

from isa_ros.analysis.validation.groups import GROUPS
from isa_ros.analysis.validation.page import write_page
from isa_ros.analysis.validation.runner import Result, run_group
from isa_ros.cli.main import main
import pytest

DOCS = Path(__file__).parents[3] / 'docs'
QUICK = [group for group in GROUPS if not group.is_long]
LONG = [group for group in GROUPS if group.is_long]


def section_of(result: Result, directory: Path) -> str:
    """Return the part of a page that is about one group."""
    page, *_ = write_page([result], directory)
    _, heading, section = page.read_text().partition(f'## {result.title}\n')
    return heading + section.rstrip()


def check(group, directory: Path) -> None:
    """Check a group against its section of docs/validation.md."""
    result = run_group(group)
    assert all(entry.is_reached or entry.reason for entry in result.entries)
    errata = set(re.findall(r'^\| (\d+) \|', (DOCS / 'paper-errata.md').read_text(), re.M))
    for entry in result.entries:
        cited = re.findall(r'\d+', entry.reading.partition(':')[0])
        assert set(cited) <= errata
    page = (DOCS / 'validation.md').read_text()
    assert section_of(result, directory) in page
    for picture in result.pictures:
        assert f'(figures/validation_{picture.name}.png)' in page
        assert (DOCS / 'figures' / f'validation_{picture.name}.png').is_file()


@pytest.mark.parametrize('group', QUICK, ids=[group.name for group in QUICK])
def test_a_group_is_as_the_shipped_page_shows_it(group, tmp_path):
    """`isa validate --out docs` was run after the last change."""
    check(group, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize('group', LONG, ids=[group.name for group in LONG])
def test_a_long_group_is_as_the_shipped_page_shows_it(group, tmp_path):
    check(group, tmp_path)


def test_names_of_groups_are_different():
    assert len({group.name for group in GROUPS}) == len(GROUPS)


def test_one_entry_by_name(capsys):
    assert main(['validate', '--only', 'actuator_data.manifold_stall']) == 0
    printed = capsys.readouterr().out
    assert printed.endswith(
        'paper: 1 entries, 0 reached, 1 reached as read, 0 not reached; '
        'own: 0 entries, 0 reached, 0 reached as read, 0 not reached\n')
    assert '177.8' in printed


def test_a_part_does_not_overwrite_the_page(tmp_path, capsys):
    """`--only` with the directory of a whole page."""
    (tmp_path / 'validation.md').write_text('whole')
    assert main(['validate', '--only', 'valve_flow', '--out', str(tmp_path)]) == 2
    assert 'validation.md already exists' in capsys.readouterr().err
    assert (tmp_path / 'validation.md').read_text() == 'whole'


def test_an_unknown_group_is_one_line_and_2(capsys):
    assert main(['validate', '--only', 'valve_flows']) == 2
    printed = capsys.readouterr().err
    assert printed == 'isa: --only valve_flows: no such group; did you mean valve_flow?\n'
