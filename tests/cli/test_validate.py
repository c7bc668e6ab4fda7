"""The exit code of `isa validate`: 0 where all entries are reached, 1 where one is not."""

from isa_ros.cli.main import main
from isa_ros.validation import groups
import pytest
from tests.validation.groups import GOOD, MISSED


@pytest.mark.parametrize(('shipped', 'only', 'code'), [
    ((GOOD,), [], 0), ((GOOD, MISSED), [], 1), ((GOOD, MISSED), ['--only', 'good'], 0),
    ((GOOD, MISSED), ['--only', 'missed'], 1)])
def test_an_entry_that_is_missed_is_the_answer_no(
        shipped, only, code, monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str]) -> None:
    """A continuous integration that asks for the exit code alone must be told."""
    monkeypatch.setattr(groups, 'GROUPS', shipped)
    assert main(['validate', *only]) == code
    assert ('the spring is too soft' in capsys.readouterr().out) == (code == 1)


def test_the_help_has_the_exit_code(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        main(['validate', '--help'])
    assert end.value.code == 0
    assert 'Exits with 1 if an entry of either source' in ' '.join(
        capsys.readouterr().out.split())
