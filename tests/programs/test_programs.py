"""The programs, from their first line on: signals while they load, and defects of their own."""

from collections.abc import Iterator
import os
from pathlib import Path
import signal
import subprocess
import sys

from isa_ros.cli.main import make_parser
from isa_ros.core.openblas import VARIABLE
from isa_ros.processes.ending import REPORT_TO
from isa_ros.programs import actuator, isa
import pytest
from tests.threads import forget_number

ROOT = Path(__file__).parents[2]
PROGRAMS = {'isa_ros.programs.actuator': 0, 'isa_ros.programs.coordinator': 130, 'isa_ros': 130}
"""Modules of the programs, and the exit code of one that is interrupted before it has begun."""

AT_AN_IMPORT = """
import os, signal, sys
class Looking:
    def find_spec(self, name, path, target=None):
        if name == {name!r}:
            {act}
sys.meta_path.insert(0, Looking())
"""


@pytest.fixture
def imports(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Return the file that Python runs first in every process."""
    path = os.pathsep.join([str(tmp_path), str(ROOT)])
    monkeypatch.setenv('PYTHONPATH', path)
    yield tmp_path / 'sitecustomize.py'


def ended(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Run ``python -m ARGUMENTS`` to its end."""
    return subprocess.run(
        [sys.executable, '-m', *arguments], capture_output=True, text=True, timeout=60.0)


@pytest.mark.usefixtures('heard_hang_up')
@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize('module', PROGRAMS)
def test_a_signal_while_a_program_loads_ends_it_at_once(
        module: str, number: signal.Signals, imports: Path) -> None:
    """The library that is imported would swallow an exception."""
    loaded = 'isa_ros.cli.commands' if module == 'isa_ros' else 'rclpy'
    imports.write_text(AT_AN_IMPORT.format(name=loaded, act=f"""
            try:
                os.kill(os.getpid(), {int(number)})
            except BaseException:
                pass"""))
    result = ended(module, '--help')
    assert (result.returncode, result.stdout) == (PROGRAMS[module], '')
    name = module.rpartition('.')[2].removesuffix('_ros')
    assert result.stderr == (f'{name}: interrupted\n' if result.returncode else '')


@pytest.mark.parametrize('module', PROGRAMS)
def test_a_defect_is_70_and_one_line(module: str, imports: Path) -> None:
    loaded = 'isa_ros.cli.commands' if module == 'isa_ros' else 'isa_ros.actuator.kernel'
    imports.write_text(AT_AN_IMPORT.format(name=loaded, act='raise AssertionError(name)'))
    result = ended(module, '--help')
    assert (result.returncode, result.stdout) == (70, '')
    assert result.stderr.count('\n') == 1
    assert f'AssertionError: {loaded}' in result.stderr and REPORT_TO in result.stderr


def test_a_machine_without_ros_is_told_what_is_missing(imports: Path) -> None:
    imports.write_text(AT_AN_IMPORT.format(
        name='rclpy', act='raise ModuleNotFoundError("No module", name=name)'))
    result = ended('isa_ros.programs.actuator', '--help')
    assert result.returncode == 2
    assert result.stderr == (
        'actuator: the Python package rclpy is missing; source ROS 2 Jazzy, or use ./isa, which '
        'makes an environment\n')


@pytest.mark.parametrize('words, number', [
    (['isa', 'params', 'isa_v5'], '1'), (['isa', 'report'], '1'), (['isa'], None),
    (['isa', 'bringup', 'params'], None), (['isa', '--help', 'params'], None),
    (['params', 'replay'], None)])
def test_commands_without_a_run_begin_no_threads_for_matrices(
        words: list[str], number: str | None, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run keeps those of a program of the user, whose controllers have to give the same bits."""
    forget_number(monkeypatch)
    monkeypatch.setattr(sys, 'argv', words)
    isa._loaded()
    assert os.environ.get(VARIABLE) == number


def test_each_of_them_is_a_command() -> None:
    for name in isa.WITHOUT_RUN:
        with pytest.raises(SystemExit) as ended:
            make_parser([name]).parse_args([name, '--help'])
        assert ended.value.code == 0


def test_an_actuator_begins_none(monkeypatch: pytest.MonkeyPatch) -> None:
    forget_number(monkeypatch)
    monkeypatch.setattr(actuator, 'run_program', lambda name, load, interrupted: bool(load()))
    assert actuator.main() and os.environ[VARIABLE] == '1'
