"""What `./isa test --quick` leaves out."""

from pathlib import Path
import re

import pytest
from tests import quick

TESTS = Path(__file__).parents[1]
REPORT = """<testsuites><testsuite>
<testcase classname="tests.plant.test_spool" name="test_it_moves[1]" time="0.4"/>
<testcase classname="tests.plant.test_spool_ends" name="test_it_moves[2]" time="0.1"/>
<testcase classname="tests.plant.test_spool" name="test_it_stops[1]" time="0.2"/>
<testcase classname="tests.plant.test_spool" name="test_it_stops[2]" time="0.2"/>
<testcase classname="tests.ros.lockstep.test_all" name="test_one_of_its_kind" time="9"/>
<testcase classname="tests.test_controller" name="test_it_waits" time="3"/>
</testsuite></testsuites>"""


@pytest.fixture
def item(request: pytest.FixtureRequest) -> pytest.Item:
    """Return the test that asks for it."""
    return request.node


def test_names_are_those_of_tests() -> None:
    """All but one in twenty: what is renamed takes its time until all are measured anew."""
    names = [line.removeprefix('+') for line in quick.FILE.read_text().splitlines()]
    assert len(set(names)) == len(names) > 50
    sources: dict[str, str] = {}
    unknown = []
    for name in names:
        place, function = name.split()
        if place not in sources:
            files = [TESTS / f'{place}.py', *(TESTS / place).rglob('test_*.py')]
            sources[place] = ''.join(file.read_text() for file in files if file.exists())
        if not re.search(rf'^def {function}\(', sources[place], re.MULTILINE):
            unknown.append(name)
    assert len(unknown) < 0.05 * len(names), unknown


def test_what_takes_long_with_one_of_its_parameters_is_left_out(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """But not the only one of its kind."""
    monkeypatch.setattr(quick, 'FILE', tmp_path / 'quick.txt')
    kept = '+ros test_one_of_its_kind\n'
    quick.FILE.write_text(f'{kept}tick test_that_is_gone\n')
    (tmp_path / 'times.xml').write_text(REPORT)
    quick.main(tmp_path / 'times.xml')
    assert quick.FILE.read_text() == (
        f'{kept}plant test_it_moves\ntest_controller test_it_waits\n')
    assert quick.left_out() == {'plant test_it_moves', 'test_controller test_it_waits'}


def test_what_takes_long_without_others_is_left_out_too(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It makes what they shared; they are not in the report, and are left out as before."""
    monkeypatch.setattr(quick, 'FILE', tmp_path / 'quick.txt')
    quick.FILE.write_text('+ros test_one_of_its_kind\ntick test_made_what_others_take\n')
    (tmp_path / 'times.xml').write_text(REPORT)
    quick.main(tmp_path / 'times.xml', is_more=True)
    assert quick.FILE.read_text() == (
        '+ros test_one_of_its_kind\nplant test_it_moves\n'
        'test_controller test_it_waits\ntick test_made_what_others_take\n')


def test_a_test_is_left_out_by_its_name(item: pytest.Item) -> None:
    assert quick.is_quick(item, {'tick test_a_test_is_left_out_by_its_name'})
    assert not quick.is_quick(item, {'style test_a_test_is_left_out_by_its_name'})


@pytest.mark.slow
def test_a_slow_one_is_left_out(item: pytest.Item) -> None:
    assert not quick.is_quick(item, set())
