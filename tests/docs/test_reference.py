"""The pages of docs/reference are those of the code."""

import isa_ros
from isa_ros.cli.main import make_parser
import pytest
from scripts import write_reference
from scripts.reference import api, cli, exit_codes, markup


@pytest.mark.parametrize('name', sorted(write_reference.PAGES))
def test_a_page_is_that_of_the_code(name: str) -> None:
    """`python -m scripts.write_reference` after a change of what it shows."""
    page = write_reference.FOLDER / f'{name}.md'
    assert page.read_text(encoding='utf-8') == write_reference.PAGES[name]()


def test_there_is_no_other_page() -> None:
    assert {page.stem for page in write_reference.FOLDER.iterdir()} == set(write_reference.PAGES)


def test_each_command_has_its_arguments() -> None:
    """Those of nested commands too, with their metavars; positional ones by theirs."""
    page = cli.cli_page()
    for command in ('demo', 'bringup', 'bus ethercat', 'bus describe', 'completion'):
        assert f'# isa {command}\n' in page
    assert '| `--set KEY=VALUE` | another value in CONFIG' in page
    assert '| `CONFIG` | a run file, or a shipped one by name |' in page
    assert page.count('\n## isa ') == page.count('\n## ')
    assert '%(' not in page and '--debug' not in page and '<' not in page
    assert make_parser().prog == 'isa'


def test_each_public_name_has_its_section() -> None:
    page = api.api_page()
    assert [line[3:] for line in page.split('\n') if line.startswith('## ')] == sorted(
        isa_ros.__all__, key=str.lower)
    assert '| `stiffness` | `float or None` | `None` | None keeps the gain in force' in page
    assert 'self' not in ''.join(line for line in page.split('\n') if line.startswith('Run'))
    assert '### Result.save' in page and '\n-----' not in page


def test_a_property_has_no_parentheses_and_private_members_are_not_shown() -> None:
    parts = '\n'.join(api.section('Simulation', isa_ros.Simulation))
    assert '### Simulation.t_ns\n\nReturn' not in parts     # paragraphs are joined by the page
    assert '### Simulation.t_ns\nReturn the simulated time, ns.' in parts
    assert 'Simulation.step(commands' in parts and '_assemble' not in parts


def test_exit_codes_are_those_of_the_errors() -> None:
    page = exit_codes.exit_codes_page()
    assert '| `isa_ros.errors.SimulationDiverged` | 4 |' in page
    assert '| `isa_ros.errors.BagError` | 2 |' in page and '| 130 | interrupted' in page


def test_commands_that_may_fail_on_a_trip_are_those_of_the_page() -> None:
    """As the page of commands has them, which is made from their parsers."""
    sections = cli.cli_page().split('\n## ')[1:]
    own = [section.split()[1] for section in sections if '`--fail-on-trip`' in section]
    assert own == ['bringup', 'bus', 'view']
    page = ' '.join(exit_codes.exit_codes_page().split())
    assert 'with `--fail-on-trip`, of `isa bringup`, `isa bus` and `isa view`' in page


def test_markdown_takes_no_text_for_markup() -> None:
    assert markup.escaped('a  <b>\n*c* | d & e') == r'a &lt;b> \*c\* or d &amp; e'
    assert markup.docstring('A.\n\nRaises\n------\nX\n    ``y``::\n\n    z') == (
        'A.\n\n**Raises**\n\nX\n    `y`:\n\n    z')
