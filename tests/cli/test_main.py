"""The command line: exit codes, one line per error, and imports that are avoided."""

from argparse import Namespace
import errno
import os
from pathlib import Path
import signal
import subprocess
import sys

from isa_ros.cli import main as cli
from isa_ros.errors import (
    BagError, ConfigError, IsaError, ParameterError, RunError, SimulationDiverged)
from isa_ros.run.session import Session
import pytest

ROOT = Path(__file__).parents[2]


def outcome(monkeypatch: pytest.MonkeyPatch, ending: BaseException | bool, *more: str) -> int:
    """Return the exit code of a command that ends with an error."""
    def command(options: Namespace) -> bool:
        if isinstance(ending, bool):
            return ending
        raise ending

    add_arguments, _, summary = cli._COMMANDS['params']
    monkeypatch.setitem(cli._COMMANDS, 'params', (add_arguments, command, summary))
    return cli.main([*more, 'params', 'isa_v5'])


@pytest.mark.parametrize('ending, code', [
    (True, 0), (False, 1), (ConfigError('x'), 2), (ParameterError('x'), 2), (BagError('x'), 2),
    (PermissionError(errno.EACCES, 'Permission denied', 'out'), 2),
    (RunError('x'), 3), (OSError(errno.ENOSPC, 'No space left on device', 'out'), 3),
    (SimulationDiverged(1_000_000, 'spool', float('nan')), 4), (KeyError('x'), 70),
    (KeyboardInterrupt(), 130),
])
def test_the_exit_codes_are_those_of_the_interface(
        ending: BaseException | bool, code: int, monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str]) -> None:
    """Interface.md: 0 done, 1 no, 2 input, 3 not completed, 4 diverged, 70, 130 interrupted."""
    assert outcome(monkeypatch, ending) == code
    assert capsys.readouterr().err.count('\n') == (code > 1)


def test_an_error_names_what_the_system_refused(
        monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    outcome(monkeypatch, PermissionError(errno.EACCES, 'Permission denied', 'out/bag'))
    assert capsys.readouterr().err == 'isa: out/bag: Permission denied\n'


def test_debug_shows_the_traceback_and_keeps_the_exit_code(
        monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert outcome(monkeypatch, IsaError('wrong'), '--debug') == 2
    printed = capsys.readouterr().err
    assert 'Traceback' in printed and printed.endswith('isa: wrong\n')
    assert 'debug' in cli.make_parser().parse_args(['params', 'isa_v5', '--debug'])


@pytest.mark.parametrize('arguments, expected', [
    ([], 'isa: the following arguments are required: COMMAND'),
    (['fly'], "invalid choice: 'fly'"),
    (['bringup'], 'isa bringup: the following arguments are required: CONFIG'),
    (['bringup', 'leg', '--duration', '0'], "argument --duration: '0' must be a number > 0"),
    (['bringup', 'leg', '--duration', 'nan'], "argument --duration: 'nan' must be"),
    (['bringup', 'leg', '--real-time-factor', 'x'], "--real-time-factor: 'x' must be"),
    (['bringup', 'leg', '--elsewhere', 'hfe,'],
     "isa bringup: argument --elsewhere: 'hfe,' must be names separated by commas"),
    (['bode', 'isa_v5', '--json', '/none/x.json'],
     'isa bode: argument --json: /none/x.json: the directory /none does not exist; see isa bode '
     '--help'),
    (['step', 'isa_v5', '--out', '/'],
     'isa step: argument --out: / is a directory, must be a file'),
    (['validate', '--out', f'{__file__}/docs'],
     f'isa validate: argument --out: {__file__}/docs: {__file__} is a file, must be a directory'),
    (['params', 'isa_v5', '--presets', 'x'], 'unrecognized arguments: --presets'),
    (['bode', 'isa_v5', '--open'],
     'isa bode: unrecognized arguments: --open; see isa bode --help'),
    (['command', 'ram', '--stiffness', '1e5', '0.1', '0.2'],
     'isa command: unrecognized arguments: 0.2; see isa command --help'),
    (['paper', '--', '--debug', 'table_1'],
     'isa paper: unrecognized arguments: table_1; see isa paper --help'),
    (['bus', '--fast', 'ethercat', 'leg', '--interface', 'ecs'],
     'isa bus: unrecognized arguments: --fast; see isa bus --help'),
])
def test_wrong_usage_is_one_line_and_2(
        arguments: list[str], expected: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        cli.main(arguments)
    assert caught.value.code == 2
    printed = capsys.readouterr().err
    assert expected in printed and printed.count('\n') == 1


@pytest.mark.parametrize('words', [
    'ram 0.1 --stiffness 1e5 --velocity -0.3', 'ram --stiffness 1e5 0.1 --velocity -0.3',
    '--stiffness 1e5 ram --velocity -0.3 0.1'])
def test_what_may_be_left_out_may_stand_anywhere(words: str) -> None:
    options = cli.make_parser(['command']).parse_args(['command', *words.split()])
    assert (options.actuator, options.position, options.velocity, options.stiffness) == (
        'ram', 0.1, -0.3, 1e5)


def test_a_parser_reads_a_line_after_one_that_it_has_refused(capsys):
    parser = cli.make_parser(['command'])
    with pytest.raises(SystemExit):
        parser.parse_args(['command', 'ram', '--stiffness', '1e5', 'abc'])
    assert "position: 'abc'" in capsys.readouterr().err.lower()
    options = parser.parse_args(['command', 'ram', '--stiffness', '1e5', '0.1'])
    assert (options.actuator, options.position, options.stiffness) == ('ram', 0.1, 1e5)


def test_names_may_stand_behind_an_option() -> None:
    """Also the second time that a parser is asked."""
    parser = cli.make_parser(['actuators'])
    for _ in range(2):
        options = parser.parse_args(
            ['actuators', 'leg', '--set', 'hfe.load.mass=3', 'hfe', 'kfe'])
        assert (options.config, options.names, options.set) == (
            'leg', ['hfe', 'kfe'], ['hfe.load.mass=3'])


@pytest.mark.parametrize('arguments, expected', [
    (['params', 'isa_v6'], 'isa: isa_v6: no such file; did you mean isa_v5 or isa_v2?'),
    (['params', 'isa_v5', '--preset', 'fast'], "isa: preset = 'fast' is not a preset of isa_v5"),
    (['bringup', 'no_such_run'], 'isa: no_such_run: no such file; shipped: cooled_station.yaml'),
    (['bringup', 'leg', '--scenario', 'fly'],
     'isa: fly: no such file; shipped: cooled_station.yaml, crane_circuit.yaml'),
    (['bringup', 'leg', '--scenario', 'step'],
     'isa: step.yaml: loads.rotor is unknown: leg.yaml: no actuator'),
    (['bringup', 'leg', '--duration', '0.0005'],
     'isa: duration = 0.0005 s, must be a multiple of step_ms = 1 ms'),
    (['bringup', 'leg', '--elsewhere', 'hfe,knee'],
     "isa: leg.yaml: no actuator 'knee'; valid: haa, hfe, kfe"),
    (['bringup', 'leg', '--elsewhere', 'hfe', '--in-process'],
     'isa: --elsewhere hfe cannot be used with --in-process'),
    (['actuators', 'leg', 'knee'], "isa: leg.yaml: no actuator 'knee'; valid: haa, hfe, kfe"),
    (['compare', 'no_bag', 'no_bag'], 'isa: no_bag'),
    (['report', 'no_bag'], 'isa: no_bag'),
    (['replay', 'no_bag'], 'isa: no_bag'),
])
def test_unreadable_input_is_one_line_and_2(
        arguments: list[str], expected: str, capsys: pytest.CaptureFixture[str],
        monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(arguments) == 2
    printed = capsys.readouterr().err
    assert printed.startswith(expected) and printed.count('\n') == 1
    assert not list(tmp_path.iterdir())


def test_params_shows_the_values_after_a_change(capsys: pytest.CaptureFixture[str]) -> None:
    """As bode, step and bringup would use them."""
    assert cli.main(['params', 'isa_v5', '--set', 'reu.force.kf=0.001']) == 0
    row = next(line for line in capsys.readouterr().out.splitlines()
               if line.startswith('reu.force.kf '))
    assert row.split()[1] == '0.001' and ' --set ' in row


def test_bringup_warns_before_it_starts_anything(
        capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch,
        tmp_path: Path) -> None:
    """Of ticks too long for an impact on metal; one line."""
    def run_session(session: Session, report: object) -> Path:
        assert 'isa: leg.yaml: on the ground of the leg' in capsys.readouterr().err
        return session.out
    monkeypatch.setattr('isa_ros.nodes.bringup.run_session', run_session)
    assert cli.main(['bringup', 'leg', '--set', 'leg.ground=metal', '--out',
                     str(tmp_path / 'bag')]) == 0
    assert capsys.readouterr() == ('', '')


def test_help_imports_neither_ros_nor_numba() -> None:
    """`isa --help` answers at once; numba alone costs half a second."""
    program = (
        'import sys\n'
        'from isa_ros.cli.main import make_parser\n'
        'make_parser().format_help()\n'
        'print(sorted({"numba", "numpy", "rclpy", "yaml"} & set(sys.modules)))\n')
    # -I: without the site's .pth files and the user's environment.
    result = subprocess.run(
        [sys.executable, '-c', f'import sys; sys.path.insert(0, {str(ROOT)!r})\n{program}'],
        capture_output=True, text=True, check=True)
    assert result.stdout == '[]\n'


@pytest.mark.usefixtures('heard_hang_up')
@pytest.mark.parametrize('number', [signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_a_command_like_ctrl_c(
        number: signal.Signals, monkeypatch: pytest.MonkeyPatch) -> None:
    def command(options: Namespace) -> bool:
        os.kill(os.getpid(), number)
        signal.sigtimedwait([], 5.0)  # not reached: the handler raises before
        return True

    before = signal.getsignal(number)
    add_arguments, _, summary = cli._COMMANDS['params']
    monkeypatch.setitem(cli._COMMANDS, 'params', (add_arguments, command, summary))
    assert cli.main(['params', 'isa_v5']) == 130
    assert signal.getsignal(number) is before


def test_a_reader_that_has_enough_is_no_error() -> None:
    """`isa params leg.yaml | head -1`: no traceback, exit code 0."""
    with subprocess.Popen(
            [sys.executable, '-m', 'isa_ros', 'params', 'leg'], cwd=ROOT,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None and process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b''
    assert process.returncode == 0
