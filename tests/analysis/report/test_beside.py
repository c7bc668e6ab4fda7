"""Two runs over each other: what differs first, then both in each diagram."""

from dataclasses import replace
from pathlib import Path
import re

import isa_ros
from isa_ros.analysis.report.beside import names_of, over_each_other, write_comparison
from isa_ros.analysis.report.panels import Curve, Group, Panel
from isa_ros.analysis.report.report import Recorded, recorded
from isa_ros.analysis.signals.signals import Signal
from isa_ros.bag.reader import Bag
from isa_ros.cli.main import main
from isa_ros.errors import BagError
from isa_ros.replay.comparison import compared
import numpy as np
import pytest

KP = 'actuators.rotor.parameters.reu.force.kp'


@pytest.fixture(scope='module')
def bags(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Return a torque step, and a shorter one with another gain."""
    folder = tmp_path_factory.mktemp('beside')
    rig = isa_ros.load('rig_rotary', 'step', duration=0.2)
    kp = rig.configuration.actuators[0].sheet.reu.force.kp
    soft = isa_ros.load('rig_rotary', 'step', duration=0.15, changes={KP: 0.5 * kp})
    return (rig.simulate().save(folder / 'shipped'), soft.simulate().save(folder / 'soft'))


@pytest.fixture(scope='module')
def runs(bags: tuple[Path, Path]) -> tuple[Recorded, Recorded]:
    return recorded(bags[0]), recorded(bags[1])


@pytest.fixture(scope='module')
def page(bags, runs, tmp_path_factory: pytest.TempPathFactory) -> Path:
    comparison = compared(*map(Bag, bags))
    written = write_comparison(
        comparison, runs, tmp_path_factory.mktemp('page') / 'compare.html')
    assert [path.name for path in written] == [
        'compare.html', 'compare_rotor.png', 'compare_rotor.svg']
    return written[0]


def test_differences_of_the_configuration_come_first(page):
    text = page.read_text()
    row = re.search(f'<tr><td>{KP}</td><td>([^<]*)</td><td>([^<]*)</td>', text)
    assert row and float(row[1]) == 2.0 * float(row[2])
    places = [text.index(part) for part in (
        '<h2>Differences</h2>', row[0], '/rotor/joint_states', '<h2>shipped</h2>',
        '<h2>soft</h2>', '<main>')]
    assert places == sorted(places)
    assert '<th>shipped</th><th>soft</th>' in text


def test_both_runs_are_drawn_with_their_names_and_states(browser, page):
    browser.load(page)
    entries = browser.run("return [...document.querySelectorAll('.legend')]"
                          ".map(own => [...own.querySelectorAll('span span')]"
                          '.map(e => e.textContent))')
    bands = browser.run(
        "return [...document.querySelectorAll('.band')].map(e => e.textContent)")
    shown = browser.run("return document.getElementById('range').textContent")
    browser.run("document.querySelector('main').scrollIntoView()")
    browser.move('#group-rotor .u-over', 400, 0)
    browser.wait("return document.getElementById('cursor').textContent !== ''")
    values = browser.run("return [...document.querySelectorAll('.legend')[1]"
                         ".querySelectorAll('b')].map(e => e.textContent)")
    assert browser.log() == []
    assert entries[1] == ['shipped: estimated', 'soft: estimated']
    assert bands == ['shipped rotor: initialising', 'shipped rotor: enabled',
                     'soft rotor: initialising', 'soft rotor: enabled']
    assert shown == '0.0000 to 0.2000 s'
    assert values[1] == '\u2013' and float(values[0]) == float(values[0])   # soft ended at 0.15 s


def test_runs_of_one_name_are_called_by_their_place(runs):
    assert names_of(runs) == ('shipped', 'soft')
    assert names_of((runs[0], runs[0])) == ('expected', 'actual')


def group(values: list[float], t: list[float], title: str = 'force') -> Group:
    signal = Signal(np.array(t), np.array(values))
    return Group('ram', 'ram', [Panel(title, 'kN', 1e3, [Curve('measured', signal)], '')],
                 ('ram',))


def test_a_caption_says_how_far_apart_they_are():
    """At the times of both: 3, 0 and -4 kN apart, rms 5/sqrt(3)."""
    one = group([0.0, 1e3, 2e3, 3e3, 9e9], [0.0, 0.1, 0.2, 0.3, 0.35])
    other = group([4e3, 2e3, -1e3, 7e9], [0.1, 0.2, 0.3, 0.4])
    panel, = over_each_other('ram', (one, other), ('a', 'b')).panels
    assert [own.label for own in panel.curves] == ['a: measured', 'b: measured']
    assert panel.caption == 'measured: apart by 2.89 kN rms, at most 4, at t = 0.300 s.'
    same, = over_each_other('ram', (one, one), ('a', 'b')).panels
    assert same.caption == 'measured: equal.'
    never, = over_each_other('ram', (one, group([1.0], [7.0])), ('a', 'b')).panels
    assert never.caption == 'measured: no sample at the same time.'


def test_only_curves_of_one_name_are_held_against_each_other():
    one, other = group([1.0], [0.0]), group([2.0], [0.0])
    renamed = replace(other, panels=[replace(own, curves=[
        replace(own.curves[0], label='estimated')]) for own in other.panels])
    panel, = over_each_other('ram', (one, renamed), ('a', 'b')).panels
    assert panel.caption == '' and [own.label for own in panel.curves] == [
        'a: measured', 'b: estimated']


def test_a_panel_or_group_of_one_run_is_shown_alone():
    one, other = group([1.0], [0.0]), group([2.0], [0.0], title='torque')
    both = over_each_other('ram', (one, other), ('a', 'b'))
    assert [(own.title, own.caption) for own in both.panels] == [
        ('force', 'In one of the runs only.'), ('torque', 'In one of the runs only.')]
    alone = over_each_other('ram', (None, other), ('a', 'b'))
    assert [own.label for own in alone.panels[0].curves] == ['b: measured']


def test_panels_of_one_title_stay_apart():
    """As those of the joints of a robot's legs."""
    first = group([1.0], [0.0])
    twice = replace(first, panels=[*first.panels, *group([5.0], [0.0]).panels])
    both = over_each_other('ram', (twice, twice), ('a', 'b'))
    assert [own.title for own in both.panels] == ['force', 'force (2)']
    assert [own.signal.values[0] for own in both.panels[1].curves] == [5.0, 5.0]


def test_the_command_writes_it_and_still_answers_no(bags, tmp_path, capsys):
    page = tmp_path / 'both.html'
    assert main(['compare', *map(str, bags), '--report', str(page)]) == 1
    assert f'\n{page}\n{tmp_path / "both_rotor.png"}\n' in capsys.readouterr().out
    assert main(['compare', str(bags[0]), str(bags[0]), '--report', str(page)]) == 0
    assert 'configuration, scenario and versions are equal' in page.read_text()


def test_a_measurement_of_others_has_no_such_page(bags, tmp_path, capsys):
    assert main(['compare', *map(str, bags), '--mapping', 'a.yaml', '--report']) == 2
    assert '--report is of two bags of isa_ros, and cannot be used' in capsys.readouterr().err


def test_another_file_is_not_replaced(bags, runs, tmp_path):
    page = tmp_path / 'mine.html'
    page.write_text('precious')
    with pytest.raises(BagError, match='mine.html already exists and is not a report'):
        write_comparison(compared(*map(Bag, bags)), runs, page)
    assert page.read_text() == 'precious'
