"""`isa compare` and `isa identify` take measurements too."""

import json
from pathlib import Path

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.cli.main import main
import numpy as np
import pytest
from scripts.made_measurement import measured, PositionSweep


def test_a_measurement_is_compared_with_the_bag_of_its_run(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Of the same machine: what differs is the noise that was added."""
    path, mapping = measured(tmp_path, 0.6, {}, clock_ppm=0.0)
    bag = isa_ros.load('rig_linear').simulate(0.6, [PositionSweep()]).save(tmp_path / 'bag')
    out = tmp_path / 'fits.json'
    assert main(['compare', str(path), str(bag), '--mapping', str(mapping),
                 '--json', str(out)]) == 0
    assert 'actual against expected' in capsys.readouterr().out
    tree = json.loads(out.read_text())
    assert set(tree) == {'position', 'force', 'pressure_a', 'pressure_b'}
    assert tree['position']['gain'] == pytest.approx(1.0, abs=0.01)
    assert abs(tree['position']['delay']) < 1e-3 and tree['position']['nrmse'] < 0.01


def test_a_bag_is_read_by_topic_and_field(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """As if another recorder had made it: an MCAP file under another name, with a mapping."""
    path, mapping = measured(tmp_path, 0.6, {}, noise=0.0, clock_ppm=0.0)
    bag = isa_ros.load('rig_linear').simulate(0.6, [PositionSweep()]).save(tmp_path / 'bag')
    other = tmp_path / 'other.yaml'
    other.write_text("signals:\n  position: {topic: /ram/joint_states, field: 'position[0]', "
                     'unit: mm, scale: 1000}\n')
    from isa_ros.analysis.measured.mapping import load_mapping
    from isa_ros.analysis.measured.measurement import read_measurement
    by_topic = read_measurement(bag, load_mapping(other), False).signals['position']
    by_column = read_measurement(path, load_mapping(mapping), False).signals['position']
    assert np.abs(by_topic.values - by_column.values).max() < 1e-5 and len(by_topic.t) == 601
    assert Bag(bag).counts['/ram/joint_states'] == 601


@pytest.mark.parametrize('arguments, expected', [
    (['--tolerance', 'x.yaml'], '--tolerance is not used with --mapping'),
    (['--report'], '--report is of two bags of isa_ros, and cannot be used with --mapping'),
    ([], 'nothing in common')])
def test_a_comparison_that_cannot_be_made_is_2(
        tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str],
        expected: str) -> None:
    (tmp_path / 'a.csv').write_text('1,2\n2,3\n')
    for name, quantity in (('a', 'position'), ('b', 'velocity')):
        unit = 'mm' if name == 'a' else 'mm/s'
        (tmp_path / f'{name}.yaml').write_text(
            f'time: {{rate_hz: 10}}\nsignals: {{{quantity}: {{column: 1, unit: {unit}}}}}\n')
    csv = str(tmp_path / 'a.csv')
    assert main(['compare', csv, csv, '--mapping', str(tmp_path / 'a.yaml'), '--mapping',
                 str(tmp_path / 'b.yaml'), *arguments]) == 2
    assert expected in capsys.readouterr().err


def test_two_rotary_records_are_compared(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """By the units of the mapping: twice the angle, and 3 ms later."""
    t = np.arange(400)
    x = np.sin(0.05 * t) + np.sin(0.021 * t)
    late = 2.0 * (np.sin(0.05 * (t - 3)) + np.sin(0.021 * (t - 3)))
    for name, values in (('a', x), ('b', late)):
        np.savetxt(tmp_path / f'{name}.csv', values)
    (tmp_path / 'm.yaml').write_text(
        'time: {rate_hz: 1000}\nsignals: {position: {column: 1, unit: deg}}\n')
    assert main(['compare', str(tmp_path / 'a.csv'), str(tmp_path / 'b.csv'), '--mapping',
                 str(tmp_path / 'm.yaml')]) == 0
    assert capsys.readouterr().out.splitlines()[2].split()[2:5] == ['3.00', 'ms', '1.999']


@pytest.mark.slow
def test_friction_is_identified_from_a_measurement(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The same estimates as from the bag of that run, through a file with six digits."""
    run = isa_ros.load('rig_linear', 'identify_linear', duration=12.0)
    result = run.simulate()
    bag = result.save(tmp_path / 'bag')
    names = ('position', 'force', 'pressure_a', 'pressure_b', 'spool')
    read = isa_ros.read(bag)
    columns = [read.time, *(read[f'ram.{name}'] for name in names)]
    np.savetxt(tmp_path / 'm.csv', np.stack(columns, axis=1), '%.9g', ';')
    units = dict(zip(names, ('m', 'N', 'Pa', 'Pa', 'm')))
    (tmp_path / 'm.yaml').write_text('time: {column: 1}\nsignals:\n' + ''.join(
        f'  {name}: {{column: {k}, unit: {units[name]}}}\n' for k, name in enumerate(names, 2)))
    found = {}
    for name, arguments in (('bag', [str(bag)]), ('csv', [
            str(tmp_path / 'm.csv'), '--mapping', str(tmp_path / 'm.yaml'), '--config',
            'rig_linear'])):
        assert main(['identify', *arguments, '--json', str(tmp_path / 'x.json')]) == 0
        tree = json.loads((tmp_path / 'x.json').read_text())
        found[name] = {(row['parameter'], row['unit']): row['value']
                       for row in tree['actuators']['ram'] if row['value'] is not None}
    assert len(found['csv']) >= 4 and found['csv'].keys() == found['bag'].keys()
    for key, value in found['csv'].items():
        assert value == pytest.approx(found['bag'][key], rel=0.02, abs=0.0), key


@pytest.mark.parametrize('more, expected', [
    ([], 'a measurement needs one --mapping, and --config with its actuator'),
    (['--config', 'rig_linear'], 'a.csv: lacks force, pressure_a, pressure_b, spool for an ide')])
def test_an_identification_says_what_it_lacks(
        tmp_path: Path, capsys: pytest.CaptureFixture[str], more: list[str],
        expected: str) -> None:
    (tmp_path / 'a.csv').write_text('1,2\n2,3\n')
    (tmp_path / 'a.yaml').write_text(
        'time: {rate_hz: 1000}\nsignals: {position: {column: 1, unit: mm}}\n')
    assert main(['identify', str(tmp_path / 'a.csv'), '--mapping', str(tmp_path / 'a.yaml'),
                 *more]) == 2
    assert expected in capsys.readouterr().err
