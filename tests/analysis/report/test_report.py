"""The page of a run and its figures."""

import os
from pathlib import Path
import re
from xml.etree import ElementTree

import isa_ros
from isa_ros.analysis.report.extremes import extremes
from isa_ros.analysis.report.report import recorded, write_report
from isa_ros.analysis.signals.signals import read_signals
from isa_ros.cli.main import main
from isa_ros.errors import BagError
import pytest

GOLDEN = Path(__file__).parents[2] / 'golden'
PNG = b'\x89PNG\r\n\x1a\n'


def test_a_leg_has_a_figure_of_its_own_and_one_for_each_actuator(tmp_path):
    """One self-contained page, and each figure as PNG and SVG beside it."""
    written = write_report(recorded(GOLDEN / 'leg_touchdown'), tmp_path / 'run' / 'page.html')
    assert [path.name for path in written] == ['page.html', *(
        f'page_{name}.{kind}' for name in ('leg', 'haa', 'hfe', 'kfe') for kind in ('png', 'svg'))]
    assert all(path.read_bytes().startswith(PNG) for path in written[1::2])
    assert all(ElementTree.parse(path).getroot().tag.endswith('svg') for path in written[2::2])
    page = written[0].read_text()
    assert re.findall(r'(?:src|href)="(?!data:)', page) == [] and '@import' not in page
    assert set(re.findall(r'https?://[^\s"\']+', page)) == {'https://github.com/leeoniya/uPlot'}


def test_commands_and_files_stand_on_lines_of_their_own(tmp_path):
    """As they are copied into a terminal: a newline is no code to be shown."""
    page = write_report(recorded(GOLDEN / 'rotor_step'), tmp_path / 'page.html')[0].read_text()
    first, *files = re.findall(r'<pre>(.*?)</pre>', page, re.DOTALL)
    assert first.splitlines() == [
        'isa replay rotor_step',
        'isa bringup configuration.yaml --scenario scenario.yaml --out again']
    assert len(files) == 2 and all(len(text.splitlines()) > 5 for text in files)


def test_a_rig_has_no_leg(tmp_path):
    """The rotary rig alone, in degrees and newton metres."""
    written = write_report(recorded(GOLDEN / 'rotor_step'), tmp_path / 'page.html')
    assert [path.name for path in written] == ['page.html', 'page_rotor.png', 'page_rotor.svg']


def test_another_page_is_not_replaced(tmp_path):
    page = tmp_path / 'mine.html'
    page.write_text('precious')
    with pytest.raises(BagError, match='mine.html already exists and is not a report, so'):
        write_report(recorded(GOLDEN / 'rotor_step'), page)
    assert page.read_text() == 'precious' and not list(tmp_path.glob('*.png'))
    with pytest.raises(BagError, match='is a directory, must be the name of the page'):
        write_report(recorded(GOLDEN / 'rotor_step'), tmp_path)
    os.mkfifo(tmp_path / 'pipe')
    with pytest.raises(BagError, match='pipe: is no file, must be the name of the page'):
        write_report(recorded(GOLDEN / 'rotor_step'), tmp_path / 'pipe')


def test_a_report_is_replaced_by_one(tmp_path):
    first = write_report(recorded(GOLDEN / 'rotor_step'), tmp_path / 'report.html')
    assert write_report(recorded(GOLDEN / 'rotor_step'), tmp_path / 'report.html') == first


def test_extremes_are_those_of_the_signals():
    """The table's torque peak is the signal's: the overshoot of the 17 Nm step."""
    signals = read_signals(GOLDEN / 'rotor_step')
    values = {name: (low, high, unit) for name, low, high, unit in extremes(signals)}
    torque = signals['rotor.force']
    assert values['rotor force'] == (torque.min(), torque.max(), 'Nm')
    assert values['rotor position'][2] == 'rad'
    assert 17.0 < values['rotor force'][1] < 17.0 * 1.5


@pytest.mark.parametrize(
    'topic', ['references', 'valve', 'joint_states', 'pressure_a', 'load_cell'])
def test_what_was_not_recorded_is_left_out(tmp_path, topic):
    """The rest is drawn; docs show a filter without references."""
    isa_ros.load('rig_linear', changes={'record': {'leave_out': [f'/*/{topic}']}}).simulate(
        0.01).save(tmp_path / 'bag')
    written = write_report(recorded(tmp_path / 'bag'), tmp_path / 'page.html')
    assert [path.name for path in written] == ['page.html', 'page_ram.png', 'page_ram.svg']
    rows = {name for name, *_ in extremes(read_signals(tmp_path / 'bag'))}
    assert ('ram position' in rows) is (topic != 'joint_states')


@pytest.mark.parametrize('name', ['missing', 'empty'])
def test_what_is_no_bag_is_refused(tmp_path, capsys, name):
    """The command ends with exit code 2 and one line."""
    (tmp_path / 'empty').mkdir()
    assert main(['report', str(tmp_path / name)]) == 2
    assert capsys.readouterr().err.count('\n') == 1


def test_a_foreign_figure_beside_the_page_is_not_replaced(tmp_path):
    """Neither before the first report nor beside one."""
    foreign = tmp_path / 'report_rotor.png'
    foreign.write_bytes(b'mine')
    with pytest.raises(BagError, match='report_rotor.png already exists and is not a figure of a'):
        write_report(recorded(GOLDEN / 'rotor_step'), tmp_path / 'report.html')
    assert foreign.read_bytes() == b'mine' and not (tmp_path / 'report.html').exists()
    foreign.unlink()
    write_report(recorded(GOLDEN / 'rotor_step'), tmp_path / 'report.html')
    other = tmp_path / 'report_leg.png'
    other.write_bytes(b'mine')
    with pytest.raises(BagError, match='report_leg.png already exists'):
        write_report(recorded(GOLDEN / 'leg_touchdown'), tmp_path / 'report.html')
    assert other.read_bytes() == b'mine'
    assert foreign.read_bytes().startswith(PNG)
