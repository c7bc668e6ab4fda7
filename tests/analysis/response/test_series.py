"""Several responses of one call: which, their labels, their figure."""

import json
from pathlib import Path

from isa_ros.analysis.response.series import members
from isa_ros.cli import main as cli
from isa_ros.cli.main import make_parser

SHORT = ('--from', '20', '--to', '100', '--points', '3')


def listed(*arguments: str) -> list[tuple[str, float]]:
    """Return label and gain of each member."""
    options = make_parser().parse_args(['bode', *arguments])
    return [(label, bench.config.sheet.reu.force.kp) for label, bench in members(options)]


def test_one_has_no_label():
    assert listed('isa_v5', '--set', 'reu.force.kp=9e-8') == [('', 9e-8)]


def test_every_name_is_measured_with_every_set_of_values():
    """The values of --set are those of all; a set may replace them."""
    assert listed(
        'isa_v5', 'isa_v2', '--set', 'reu.force.kp=9e-8',
        '--versus', 'reu.force.kp=2e-8,reu.force.ki=1e-6', '--versus', 'preset=default') == [
            ('isa_v5', 9e-8), ('isa_v2', 9e-8),
            ('isa_v5, reu.force.kp = 2e-08, reu.force.ki = 1e-06', 2e-8),
            ('isa_v2, reu.force.kp = 2e-08, reu.force.ki = 1e-06', 2e-8),
            ('isa_v5, preset = default', 9e-8), ('isa_v2, preset = default', 9e-8)]


def test_labels_say_what_differs():
    assert [label for label, _ in listed('isa_v5', '--versus', 'preset=table_4')] == [
        'isa_v5', 'preset = table_4']


def test_values_may_hold_commas():
    """A comma separates values only before the next key."""
    options = make_parser().parse_args([
        'bode', 'isa_v5', '--versus', 'variants=[explicit, position_control],load.inertia=2',
        '--loop', 'position'])
    assert members(options)[1].rig.values == {
        'variants': ['explicit', 'position_control'], 'load.inertia': 2}


def test_bode_overlays_prints_and_writes_all(tmp_path: Path, capsys):
    numbers, figure = tmp_path / 'bode.json', tmp_path / 'bode.svg'
    assert cli.main(['bode', 'isa_v5', 'smart_manifold', *SHORT, '--json', str(numbers),
                     '--out', str(figure)]) == 0
    printed = capsys.readouterr().out
    found = json.loads(numbers.read_text())['responses']
    assert [one['label'] for one in found] == ['isa_v5', 'smart_manifold']
    assert all(f'{one["bandwidth_hz"]:.4g} Hz' in printed for one in found)
    assert all(one['label'] in figure.read_text() for one in found)


def test_one_that_hunts_makes_the_answer_no(tmp_path: Path, capsys):
    figure = tmp_path / 'bode.svg'
    assert cli.main(['bode', 'isa_v5', '--versus', 'reu.force.kp=3e-7', *SHORT,
                     '--out', str(figure)]) == 1
    assert 'reu.force.kp = 3e-07 hunts: ' in figure.read_text()
    assert capsys.readouterr().out.count('phase margin: ') == 1


def test_steps_of_other_units_are_shares_of_the_step(tmp_path: Path, capsys):
    alike, mixed = tmp_path / 'alike.svg', tmp_path / 'mixed.svg'
    common = ('--duration', '0.05', '--out')
    assert cli.main(['step', 'isa_v5', '--versus', 'reu.force.kp=4e-8', *common, str(alike)]) == 0
    assert cli.main(['step', 'isa_v5', 'smart_manifold', *common, str(mixed)]) == 0
    assert '% of the step' in mixed.read_text() and '% of the step' not in alike.read_text()


def test_a_figure_with_two_units_is_refused_before_the_measurement(tmp_path: Path, capsys):
    assert cli.main(['bode', 'isa_v5', 'isa_v2', '--of', 'plant',
                     '--out', str(tmp_path / 'x.svg')]) == 2
    printed = capsys.readouterr()
    assert 'one figure cannot have responses in N/mA and N/mm' in printed.err
    assert printed.out == ''
