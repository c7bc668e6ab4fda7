"""Environments with the oldest and newest versions: what is asked for, found, told and written."""

from pathlib import Path
import re
import zipfile

from packaging.requirements import Requirement
from packaging.version import Version
import pytest
from scripts import check_environments
from scripts.environments import environment, interpreters
from scripts.environments.environment import CommandResult, Environment, LOWEST, needed, NEWEST

GOOD, BAD = CommandResult(True, 2.0, 'yes\n'), CommandResult(False, 3.0, 'a\nno\n')


def wheel(folder: Path) -> Path:
    path = folder / 'a-1-py3-none-any.whl'
    with zipfile.ZipFile(path, 'w') as archive:
        archive.writestr('a/METADATA', 'Requires-Dist: wrong\n')
        archive.writestr('a-1.dist-info/METADATA', (
            'Name: a\nRequires-Dist: numpy>=1.26\nRequires-Dist: PyYAML>=6.0\n'
            'Provides-Extra: test\nRequires-Dist: pytest; extra == "test"\n'
            "Requires-Dist: can>=4.3 ; extra == 'bus'\n"))
    return path


def test_what_a_wheel_needs_is_read_from_it(tmp_path: Path) -> None:
    path = wheel(tmp_path)
    assert needed(path) == ['numpy>=1.26', 'PyYAML>=6.0']
    assert needed(path, 'test') == ['pytest']
    assert [one.strip() for one in needed(path, 'bus')] == ['can>=4.3']
    assert needed(path, 'none') == []


def program(path: Path, prints: str, code: int = 0) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f'#!/bin/sh\necho {prints}\nexit {code}\n')
    path.chmod(0o755)
    return path


@pytest.fixture
def own_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a home and a PATH with nothing in them."""
    monkeypatch.setenv('HOME', str(tmp_path))
    monkeypatch.setenv('PATH', f'{tmp_path}/bin:/usr/bin:/bin')
    return tmp_path


def test_a_shim_that_runs_nothing_is_passed_over(own_home: Path) -> None:
    program(own_home / 'bin' / 'python3.10', '3.10', 127)
    assert interpreters.find('3.10') is None
    for version in ('3.10.2', '3.10.13', '3.11.7'):
        program(own_home / f'.pyenv/versions/{version}/bin/python{version[:4]}', version[:4])
    found = interpreters.find('3.10')
    assert found in {own_home / f'.pyenv/versions/3.10.{k}/bin/python3.10' for k in (2, 13)}


def test_an_interpreter_of_another_version_is_none(own_home: Path) -> None:
    program(own_home / 'bin' / 'python3.12', '3.13')
    assert interpreters.find('3.12') is None
    assert interpreters.find('3.1') is None
    program(own_home / 'bin' / 'python3.12', '3.12')
    assert interpreters.find('3.12') == own_home / 'bin' / 'python3.12'


def uv(monkeypatch: pytest.MonkeyPatch, *outcomes: CommandResult) -> list[list[str]]:
    """Answer commands with outcomes in turn; return the list of commands, filled as they come."""
    commands: list[list[str]] = []
    answers = iter(outcomes)

    def outcome(command: list[str], folder: Path, timeout: float, **more: str) -> CommandResult:
        commands.append([part.replace(str(folder), '.') for part in command])
        return next(answers)

    monkeypatch.setattr(environment, 'outcome', outcome)
    return commands


def test_the_oldest_versions_are_those_of_what_the_wheel_names(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By name: what these need in turn is as new as they allow."""
    commands = uv(monkeypatch, GOOD, GOOD, GOOD)
    own = Environment(tmp_path / 'env', Path('/a/python'), LOWEST)
    assert own.make(wheel(tmp_path)) == GOOD
    assert commands[0] == ['uv', 'venv', '--quiet', '--python', '/a/python', './env']
    assert commands[1] == [
        'uv', 'pip', 'install', '--quiet', '--python', './env/bin/python', '--only-binary',
        ':all:', '--no-binary=empy', '--resolution', 'lowest-direct', 'numpy>=1.26', 'PyYAML>=6.0']
    assert commands[2][3:] == [
        '--quiet', '--python', './env/bin/python', '--no-deps', './a-1-py3-none-any.whl']


def test_the_newest_versions_are_asked_for_too(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    commands = uv(monkeypatch, GOOD, BAD)
    own = Environment(tmp_path / 'env', Path('/a/python'), NEWEST)
    assert own.make(wheel(tmp_path)) == BAD
    assert commands[1][commands[1].index('--resolution') + 1] == 'highest'


def test_what_cannot_be_made_is_not_gone_on_with(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    commands = uv(monkeypatch, BAD)
    assert Environment(tmp_path / 'env', Path('/a'), NEWEST).make(wheel(tmp_path)) == BAD
    assert len(commands) == 1


def test_an_outcome_has_output_errors_and_time(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('PYTHONPATH', '/elsewhere')
    done = environment.outcome(
        ['sh', '-c', 'pwd; echo "$A-$PYTHONPATH-$UV_PYTHON_DOWNLOADS" >&2; exit 3'], tmp_path,
        60.0, A='b')
    assert (done.is_good, done.output) == (False, f'{tmp_path}\nb--never\n')
    assert done.last_line == 'b--never' and 0.0 < done.seconds < 60.0
    assert environment.outcome(['true'], tmp_path, 60.0) == CommandResult(True, pytest.approx(
        0.0, abs=60.0), '')
    assert environment.outcome(['no-such-program'], tmp_path, 60.0).output == (
        'no-such-program: No such file or directory')
    slow = environment.outcome(['sleep', '60'], tmp_path, 0.2)
    assert not slow.is_good and slow.output == 'not finished after 0 s'


def test_steps_end_at_the_one_that_fails() -> None:
    done: list[int] = []

    def step(k: int, outcome: CommandResult) -> CommandResult:
        done.append(k)
        return outcome

    steps = [lambda k=k, own=own: step(k, own) for k, own in enumerate((GOOD, BAD, GOOD))]
    assert check_environments.in_turn(steps) == CommandResult(False, 5.0, 'a\nno\n')
    assert done == [0, 1]
    assert check_environments.in_turn(steps[:1]) == GOOD


class Known:
    """An environment of which all is known; its leg has a digest."""

    made, digest, fails = GOOD, 'abc', ''

    def __init__(self, folder: Path, python: Path, versions: str) -> None:
        self.name = folder.name

    def make(self, wheel: Path) -> CommandResult:
        return self.made

    def version_of(self, package: str) -> str:
        return f'{package}-1'


@pytest.fixture
def known(monkeypatch: pytest.MonkeyPatch) -> type[Known]:
    class Own(Known):
        pass

    def checks(own: Known, wheel: Path) -> list[tuple[str, CommandResult]]:
        return [(name, CommandResult(name != own.fails, 7.4, f'1\n{own.digest}\n'))
                for name in ('command', 'leg', 'doors')]

    monkeypatch.setattr(check_environments, 'Environment', Own)
    monkeypatch.setattr(check_environments, 'checks', checks)
    monkeypatch.setattr(check_environments, 'find', lambda minor: Path('/a'))
    return Own


def row(digests: set[str], folder: Path) -> list[str]:
    return check_environments.row('3.12', LOWEST, folder / 'a.whl', folder, digests)


def test_a_row_has_versions_and_times(known: type[Known], tmp_path: Path) -> None:
    versions = [f'{name}-1' for name in check_environments.SHOWN]
    assert row(set(), tmp_path) == ['3.12', 'lowest', *versions, '7 s', '7 s', '7 s']


def test_a_leg_with_other_numbers_than_in_the_first_row_has_failed(
        known: type[Known], tmp_path: Path) -> None:
    digests: set[str] = set()
    assert '**failed**' not in row(digests, tmp_path)
    assert '**failed**' not in row(digests, tmp_path)
    known.digest = 'other'
    assert row(digests, tmp_path)[-3:] == ['7 s', '**failed**', '7 s']


def test_what_failed_is_printed(
        known: type[Known], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    known.fails = 'doors'
    assert row(set(), tmp_path)[-1] == '**failed**'
    assert capsys.readouterr().err == '3.12 lowest, doors: 1\nabc\n\n'
    known.made = BAD
    assert row(set(), tmp_path)[2:] == ['-'] * (len(check_environments.HEADER) - 3) + [
        'not installed']
    assert capsys.readouterr().err == '3.12 lowest: a\nno\n\n'


def test_a_python_that_is_not_there_is_said(
        known: type[Known], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(check_environments, 'find', lambda minor: None)
    cells = row(set(), tmp_path)
    assert len(cells) == len(check_environments.HEADER) and cells[-1] == 'no interpreter'


@pytest.mark.parametrize('cell, code', [('3 s', 0), ('**failed**', 1), ('not installed', 1)])
def test_the_exit_code_and_the_page_are_those_of_the_rows(
        cell: str, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str]) -> None:
    page = tmp_path / 'page.md'
    page.write_text('above\n<!-- environments -->\nold\n<!-- end -->\nbelow\n')
    rows: list[tuple[str, str]] = []

    def made(minor: str, versions: str, *others: object) -> list[str]:
        rows.append((minor, versions))
        return [minor, versions, *['x'] * (len(check_environments.HEADER) - 3), cell]

    monkeypatch.setattr(check_environments, 'PAGE', page)
    monkeypatch.setattr(check_environments, 'row', made)
    monkeypatch.setattr(check_environments, 'wheel_of', lambda *given: Path('a.whl'))
    monkeypatch.setattr(check_environments.shutil, 'which', lambda name: '/bin/uv')
    assert check_environments.main(['--python', '3.11', '3.13', '--write']) == code
    assert rows == [('3.11', 'lowest'), ('3.11', 'newest'), ('3.13', 'lowest'), ('3.13', 'newest')]
    text = page.read_text()
    assert text.startswith('above\n<!-- environments -->\n\n| Python | versions |')
    assert text.count(f' {cell} |') == 4 and 'old' not in text and text.endswith('below\n')
    assert len(capsys.readouterr().out.splitlines()) == 5


def test_without_uv_one_line_says_so(
        monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(check_environments.shutil, 'which', lambda name: None)
    assert check_environments.main([]) == 2
    assert capsys.readouterr().err == 'check_environments: uv: not found; pip install uv\n'


def test_a_wheel_that_cannot_be_built_is_one_line(
        monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(check_environments.shutil, 'which', lambda name: '/bin/uv')
    monkeypatch.setattr(check_environments, 'outcome', lambda *given: BAD)
    assert check_environments.main([]) == 3
    assert capsys.readouterr().err == 'check_environments: no wheel: no\n'


def table() -> list[dict[str, str]]:
    """Return the rows of the page, by their header."""
    page = check_environments.PAGE.read_text(encoding='utf-8')
    rows = [[cell.strip() for cell in line.strip('|').split('|')] for line in re.search(
        '<!-- environments -->\n\n(.*?)\n\n<!-- end', page, re.DOTALL)[1].splitlines()]
    assert rows[0] == check_environments.HEADER
    return [dict(zip(rows[0], row, strict=True)) for row in rows[2:]]


def test_the_page_has_each_python_with_both_and_nothing_failed() -> None:
    assert [(row['Python'], row['versions']) for row in table()] == [
        (python, versions) for python in interpreters.PYTHONS for versions in (LOWEST, NEWEST)]
    assert [row for row in table() if not all(
        re.fullmatch(r'\d+ s', row[check]) for check in check_environments.HEADER[7:])] == []


def test_the_declared_lowest_versions_are_those_that_were_tried() -> None:
    """With the oldest Python, which has a file of each; a bound that is raised is to be tried."""
    setup = (check_environments.ROOT / 'setup.py').read_text(encoding='utf-8')
    declared = [Requirement(text) for text in re.findall(r"'([\w-]+>=[\d.]+)'", setup)]
    bounds = {one.name: next(iter(one.specifier)).version for one in declared}
    oldest = table()[0]
    for package in check_environments.SHOWN:
        assert Version(oldest[package]).release[:2] == Version(bounds[package]).release, package
