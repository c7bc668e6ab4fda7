"""`isa draw`: what is drawn is the linkage that moves, and its lever."""

from isa_ros.analysis.linkages.drives import drives_of_run, ROD
from isa_ros.cli.main import main
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
import numpy as np
import pytest

RETRACTED = {'crane': {'lift': 0.82, 'tilt': 1.05}, 'two_joint_leg': {'hip': 0.281, 'knee': 0.281},
             'leg': {'hfe': 0.299, 'kfe': 0.299}}


@pytest.mark.parametrize('name', [*RETRACTED, 'hyq_quadruped'])
def test_a_lever_is_the_slope_of_the_position(name):
    """By differences of the second order over the range of the joint; 1 of a rotary one."""
    for drive in drives_of_run(load_run(find(name, CONFIG))):
        reach = drive.reach
        slope = np.gradient(reach.positions, reach.coordinates, edge_order=2)
        assert np.abs(slope - reach.levers).max() < 1e-3 * np.abs(reach.levers).max()
        low, high = sorted([reach.positions[0], reach.positions[-1]])
        assert low <= drive.position <= high


@pytest.mark.parametrize('name', RETRACTED)
def test_the_drawn_rod_has_its_length(name):
    """Of the drawn cylinder from pin to pin: retracted length and position, in each pose."""
    for drive in drives_of_run(load_run(find(name, CONFIG))):
        if drive.is_rotary:
            continue
        assert len(drive.poses) == 3
        for lines, position in zip(drive.poses, (
                drive.reach.positions[0], drive.position, drive.reach.positions[-1])):
            [rod] = [line for line in lines if line.part == ROD]
            links = [line for line in lines if line.part != ROD]
            assert drive.kind != 'cylinder' or all((own.points[0] == 0.0).all() for own in links)
            length = np.linalg.norm(np.diff(rod.points, axis=0))
            [own] = drive.names
            assert length == pytest.approx(RETRACTED[name][own] + position, abs=1e-9)


def test_equal_drives_are_drawn_once():
    """Four HAA, two HFE and KFE in front, and two behind, whose angles are the opposite ones."""
    found = [drive.names for drive in drives_of_run(load_run(find('hyq_quadruped', CONFIG)))]
    assert found == [
        ('lf_haa', 'rf_haa', 'lh_haa', 'rh_haa'), ('lf_hfe', 'rf_hfe'), ('lf_kfe', 'rf_kfe'),
        ('lh_hfe', 'rh_hfe'), ('lh_kfe', 'rh_kfe')]


def test_a_crane_is_drawn_from_the_command_line(tmp_path, capsys):
    out = tmp_path / 'crane.svg'
    assert main(['draw', 'crane', '--out', str(out), '--set',
                 'body.drives.lift.retracted_length_mm=821']) == 0
    printed = capsys.readouterr().out.splitlines()
    assert printed[1].split()[:2] == ['lift', 'cylinder']
    assert '0.19598 to 530.29 mm' in printed[1] and printed[-1] == str(out)
    assert out.read_text(encoding='utf-8').startswith('<?xml')


def test_a_lever_of_a_mirrored_joint_is_negative_as_in_the_figure(tmp_path, capsys):
    assert main(['draw', 'hyq_quadruped', '--out', str(tmp_path / 'hyq.svg')]) == 0
    levers = {line.split()[0]: line.split()[-4:] for line in capsys.readouterr().out.splitlines()}
    assert levers['lf_hfe'] == ['21.74', 'to', '45', 'mm']
    assert levers['lh_hfe'] == ['-45', 'to', '-21.74', 'mm']


@pytest.mark.parametrize('arguments, message', [
    (['draw', 'rig_linear', '--out', 'a.png'], 'rig_linear.yaml: has no linkage to draw'),
    (['draw', 'crane', '--out', 'a.doc'], '--out a.doc: must end in one of '),
])
def test_what_cannot_be_drawn_is_refused(
        arguments, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
