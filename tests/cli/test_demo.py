"""What `isa demo` prints: the paths in two lines, and a table of what happened."""

from argparse import Namespace
import shlex

import isa_ros
from isa_ros.cli import commands
from isa_ros.cli.main import make_parser
from isa_ros.cli.next_steps import command_name, next_steps, next_steps_text
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.text.changes import values_of
import pytest


def test_the_paths_are_two_lines_and_a_table_follows(tmp_path, monkeypatch, capsys):
    """The run itself is that of a bring-up; here it is a short one in memory."""
    out = tmp_path / 'demo'

    def record(request):
        isa_ros.load('rig_rotary', 'step', duration=0.01).simulate().save(request.out)
        print(request.out)
        return Namespace(out=request.out)
    monkeypatch.setattr(commands, 'record', record)
    assert commands.demo(Namespace(out=out, is_alone=False))
    bag, page, _, header, rotor, *rest = capsys.readouterr().out.splitlines()
    assert bag == str(out / 'bag')
    n_figures = len([*out.glob('*.png'), *out.glob('*.svg')])
    assert page == f'{out / "report.html"}, and {n_figures} figures beside it'
    assert header.split()[:3] == ['from', 'to', 'peak'] and rotor.startswith('rotor ')
    assert rest[-len(next_steps(out)) - 1] == 'what to try next:'
    assert rest[-1].split()[1:] == ['doctor', 'what', 'this', 'host', 'has']


def test_what_to_try_next_can_be_typed(tmp_path):
    """Each line is a command with options that there are; its values fit the run file."""
    bag = tmp_path / 'a demo' / 'bag'
    parser = make_parser()
    parsed = [parser.parse_args(shlex.split(line)) for line, _ in next_steps(bag)]
    assert [options.bag for options in parsed if 'bag' in options] == [bag]
    changed = [options for options in parsed if getattr(options, 'set', None)]
    run = load_run(find(changed[0].config, CONFIG), values_of(changed[0].set, '--set'))
    assert run.supplies[0].sheet.pressure_mpa == 10.0
    idle = load_run(find('leg', CONFIG))
    assert 'kfe' in [actuator.name for actuator in idle.actuators]
    compared = next(options for options in parsed if 'actual' in options)
    assert compared.actual == changed[0].out


@pytest.mark.parametrize('on_path, in_clone, expected', [
    (False, True, './isa'), (True, True, 'isa'), (False, False, 'isa')])
def test_the_command_is_called_as_it_can_be_here(
        tmp_path, monkeypatch, on_path, in_clone, expected):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv('PATH', str(tmp_path / 'bin'))
    (tmp_path / 'bin').mkdir()
    if in_clone:
        (tmp_path / 'isa').touch()
    if on_path:
        (tmp_path / 'bin' / 'isa').touch(mode=0o755)
    assert command_name() == expected
    assert next_steps_text(tmp_path).splitlines()[1].startswith(f'  {expected} replay {tmp_path}')
