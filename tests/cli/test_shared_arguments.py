"""Types of arguments: numbers as they are meant, and files that may be replaced."""

from argparse import ArgumentTypeError
from collections.abc import Callable
import os
from pathlib import Path

from isa_ros.cli.main import main, make_parser
from isa_ros.cli.shared_arguments import (
    count, figure_to_write, json_to_write, like_before, number, PNG, positive, seed)
import pytest


@pytest.mark.parametrize('of', [number, positive, count, seed])
def test_an_underscore_is_not_a_digit(of) -> None:
    """Python takes 1_0 as 10."""
    assert of('10') == 10
    with pytest.raises(ArgumentTypeError, match="'1_0' must be a "):
        of('1_0')


@pytest.mark.parametrize(('of', 'own', 'foreign', 'what'), [
    (json_to_write, b'{"a": 1}', b'rosbag2_bagfile_information:\n  version: 9\n', 'is not JSON'),
    (figure_to_write, PNG + b'...', b'\xff\xd8\xff a photograph', 'is not a PNG'),
    (like_before('of isa tune', b'# Tuned by isa tune.'), b'# Tuned by isa tune.\nname: rig\n',
     b'name: my_own_rig\n', 'is not of isa tune')])
def test_a_file_of_another_kind_is_not_replaced(
        tmp_path: Path, of, own: bytes, foreign: bytes, what: str) -> None:
    path = tmp_path / 'out'
    assert of(str(path)) == path
    for content in (own, b''):
        path.write_bytes(content)
        assert of(str(path)) == path
    path.write_bytes(foreign)
    with pytest.raises(ArgumentTypeError, match=f'already exists and {what}, so it is not over'):
        of(str(path))
    assert path.read_bytes() == foreign


@pytest.mark.parametrize('of', [json_to_write, figure_to_write, like_before('of isa tune', b'#')])
def test_a_pipe_is_neither_read_nor_replaced(tmp_path: Path, of: Callable[[str], Path]) -> None:
    """Who writes to /dev/null with every right has it afterwards; no reader waits for a writer."""
    path = tmp_path / 'pipe'
    os.mkfifo(path)
    for name in (path, Path(os.devnull)):
        with pytest.raises(ArgumentTypeError, match=f'{name} is a device or a pipe, must be a f'):
            of(str(name))
    assert path.is_fifo()


@pytest.mark.parametrize('command', [
    ['tune', 'isa_v5', '--out'], ['draw', 'two_joint_leg', '--out'],
    ['bus', 'describe', 'rig_linear', '--esi'], ['bus', 'describe', 'rig_linear', '--eds'],
    ['step', 'isa_v5', '--out'], ['step', 'isa_v5', '--json'], ['bringup', 'leg', '--save']])
def test_no_command_replaces_a_run_file(
        tmp_path: Path, command: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """One rule for all that write a file, and no option that lifts it."""
    path = tmp_path / 'mine.yaml'
    path.write_text('name: mine\n')
    with pytest.raises(SystemExit) as ended:
        make_parser().parse_args([*command, str(path)])
    assert ended.value.code == 2
    assert 'so it is not overwritten' in capsys.readouterr().err


@pytest.mark.parametrize(('arguments', 'message'), [
    (['brngup'], "isa: argument COMMAND: invalid choice: 'brngup'; did you mean bringup?"),
    (['bode', 'isa_v5', '--loop', 'curent'],
     "--loop: invalid choice: 'curent'; did you mean current?"),
])
def test_a_misspelt_choice_is_answered_with_the_nearest(
        arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    printed = capsys.readouterr().err
    assert ended.value.code == 2 and message in printed and printed.count('\n') == 1


@pytest.mark.parametrize('command', ['bode', 'step', 'tune'])
def test_the_torque_loop_of_a_cylinder_is_refused(
        command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, 'isa_v5', '--loop', 'torque']) == 2
    assert capsys.readouterr().err == (
        'isa: --loop torque: isa_v5 is not rotary, its loop is --loop force\n')


@pytest.mark.parametrize(('of', 'least'), [(seed, -1), (count, 0), (positive, 0)])
def test_a_long_text_is_quoted_in_part(of, least: int) -> None:
    """Python reads no whole number of more than 4300 digits."""
    with pytest.raises(ArgumentTypeError, match='^.{61,110}$') as error:
        of(f'{least}' + '0' * 5000 + ('x' if of is positive else ''))
    assert '000... must be a' in str(error.value)
