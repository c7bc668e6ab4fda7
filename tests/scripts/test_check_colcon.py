"""A clone in a workspace of colcon, and what the script says where a step fails."""

import os
from pathlib import Path

import pytest
from scripts import check_colcon
from scripts.environments.environment import CommandResult


@pytest.mark.slow
def test_a_clone_is_built_sourced_and_tested(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str]) -> None:
    """Of the last commit; the tests are those of a package that needs no kernel."""
    workspace = check_colcon.Workspace(tmp_path)
    made = workspace.environment()
    if not made.is_good and not os.environ.get('CI'):
        pytest.skip(f'colcon cannot be installed: {made.last_line}')
    monkeypatch.setattr(workspace, 'environment', lambda: made)     # once
    monkeypatch.setattr(check_colcon, 'Workspace', lambda folder: workspace)
    assert check_colcon.main(['tests/text', '-m', 'not linter']) == 0
    lines = [line.partition(': ') for line in capsys.readouterr().out.splitlines()]
    assert [name for name, _, _ in lines] == [
        'environment', 'clone', 'colcon build', 'sourced', 'colcon test', 'colcon test-result']
    assert lines[3][2].endswith('isa_ros 0.1.0')
    n = int(lines[5][2].split()[3])
    assert n > 20 and lines[5][2].endswith(f'{n} tests, 0 errors, 0 failures, 0 skipped')


class Said:
    """A workspace whose steps only say what they would do; one of them fails."""

    def __init__(self, fails: str) -> None:
        self._fails = fails
        self.done: list[str] = []

    def _step(self, name: str) -> CommandResult:
        self.done.append(name)
        return CommandResult(name != self._fails, 2.6, f'first\n {name} ended\n')

    def environment(self) -> CommandResult:
        return self._step('environment')

    def clone(self) -> CommandResult:
        return self._step('clone')

    def colcon(self, *arguments: str) -> CommandResult:
        return self._step(' '.join(arguments))

    def sourced(self) -> CommandResult:
        return self._step('sourced')


def test_a_step_that_fails_is_the_last_and_is_shown_whole(
        monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    said = Said('sourced')
    monkeypatch.setattr(check_colcon, 'Workspace', lambda folder: said)
    assert check_colcon.main([]) == 1
    assert said.done == ['environment', 'clone', 'build', 'sourced']
    assert capsys.readouterr().out == (
        'environment: 3 s\nclone: 3 s\ncolcon build: 3 s\n'
        'sourced: failed after 3 s\nfirst\n sourced ended\n\n')


@pytest.mark.parametrize('tests, command', [
    ([], 'test --return-code-on-test-failure'),
    (['tests/a', '-m', 'b'],
     'test --return-code-on-test-failure --pytest-args tests/a -m b')])
def test_pytest_is_given_what_the_script_is(
        tests: list[str], command: str, monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str]) -> None:
    said = Said('nothing')
    monkeypatch.setattr(check_colcon, 'Workspace', lambda folder: said)
    assert check_colcon.main(tests) == 0
    assert said.done[4:] == [command, 'test-result --verbose']
    out = capsys.readouterr().out
    assert 'sourced: 3 s, sourced ended\n' in out and 'colcon build: 3 s\n' in out


@pytest.mark.parametrize('name', check_colcon.SHARE)
def test_what_is_looked_for_in_the_share_is_in_the_checkout(name: str) -> None:
    assert (check_colcon.ROOT / name).is_file()
