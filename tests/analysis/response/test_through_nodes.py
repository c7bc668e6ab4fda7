"""The run file with which nodes measure a loop: complete, with every parameter."""

from pathlib import Path

from isa_ros.analysis.response.rig import Choice, rig
from isa_ros.analysis.response.through_nodes import run_file
from isa_ros.cli import main as cli
from isa_ros.config.runs.run_file import load_run
import pytest


@pytest.mark.parametrize('choice', [
    Choice(name='isa_v5', loop='spool', preset='table_4'),
    Choice(name='smart_manifold', loop='current', variants=('explicit',), position=12.3),
    Choice(name='leg.yaml', actuator='kfe', loop='position'),
    Choice(name='rig_rotary', loop='force', load='wheel')])
def test_a_run_file_gives_the_rig_back(choice: Choice, tmp_path: Path):
    """Blocks that are off, variants, load and position are written out in full."""
    bench, path = rig(choice), tmp_path / 'rig.yaml'
    path.write_text(run_file(bench.run))
    run = load_run(path)
    assert len(run.actuators) == 1 and run.leg is None
    read, given = run.actuators[0], bench.config
    assert (read.sheet, read.load) == (given.sheet, given.load)
    # a division and a multiplication by the scale of mm or deg: one rounding each
    assert read.initial_position == pytest.approx(given.initial_position, rel=4.5e-16, abs=0.0)
    assert (run.step_ns, run.controller_offset_ns) == (
        bench.run.step_ns, bench.run.controller_offset_ns)
    assert run.supply_of(read.name) == bench.run.supply_of(given.name)


@pytest.mark.parametrize(('arguments', 'expected'), [
    (['bode', 'isa_v5', '--nodes', '--to', '450'], 'must be <= 400 Hz: the nodes take setpoints'),
    (['bode', 'isa_v5', '--nodes', '--loop', 'current', '--to', '300', '--variant', 'explicit',
      '--of', 'plant'], '--nodes: drive is not recorded by the nodes'),
    (['bode', 'isa_v5', '--nodes', '--amplitude', '8000'], '--amplitude = 8000 N, must be <='),
    (['bode', 'isa_v5', '--bag', 'x'], '--bag x is not used: without --nodes no bag'),
    (['step', 'isa_v5', '--nodes', '--duration', '0.001'], '--duration = 0.001 s, must be 0.01')])
def test_what_nodes_cannot_measure_is_one_line_before_any_starts(arguments, expected, capsys):
    assert cli.main(arguments) == 2
    printed = capsys.readouterr()
    assert expected in printed.err and printed.err.count('\n') == 1
    assert printed.out == ''


def test_a_bag_is_not_overwritten(tmp_path: Path, capsys):
    (tmp_path / 'bag').mkdir()
    assert cli.main(['step', 'isa_v5', '--nodes', '--bag', str(tmp_path / 'bag')]) == 2
    assert 'already exists' in capsys.readouterr().err
