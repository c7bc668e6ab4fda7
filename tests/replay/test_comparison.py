"""`isa compare`: what differs in the configurations first, then the messages; JSON; exit codes."""

from collections.abc import Mapping
import json
from pathlib import Path

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.cli.main import main
from isa_ros.replay.comparison import names_of_runs
from isa_ros.run import provenance
import pytest
from tests.bag.golden import rewrite
from tests.bag.recorded import NAMES, record, tick_messages
from tests.replay.test_compare import foreign

KP = 'actuators.ram.parameters.reu.force.kp'
STEP = {'name': 'push', 'duration_s': 0.02, 'tracks': {'ram': [
    {'t_s': 0.0, 'position': 0.05}, {'t_s': 0.01, 'position': 0.051}]}}


def push(directory: Path, changes: Mapping[str, object]) -> Path:
    """Record a push of the ram with other values by key."""
    run = isa_ros.load('rig_linear', STEP).replace({KP: 8e-8})
    return run.replace(changes).simulate().save(directory)


@pytest.fixture(scope='module')
def bags(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Return the bags of one run and of some like it."""
    directory = tmp_path_factory.mktemp('bags')
    return {name: push(directory / name, changes) for name, changes in {
        'one': {}, 'same': {},
        'kp': {KP: 9e-8},
        'scenario': {'scenario.tracks.ram[1].position': 0.052},
        'patient': {'tick_timeout_s': 6.0},
        'shorter': {'scenario.duration_s': 0.015},
    }.items()}


def compare(bags: Mapping[str, Path], other: str, *more: str) -> int:
    return main(['compare', str(bags['one']), str(bags[other]), *more])


def test_equal_bags_are_said_to_be_equal(
        bags: dict[str, Path], capsys: pytest.CaptureFixture[str]) -> None:
    assert compare(bags, 'same') == 0
    first, second = capsys.readouterr().out.splitlines()
    assert first == 'configuration, scenario and versions are equal'
    assert second.startswith('equal: 21 ticks, ')


def test_edited_kernels_are_one_line(
        tmp_path: Path, bags: dict[str, Path], capsys: pytest.CaptureFixture[str],
        monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where the messages are equal; the version of the package has not changed."""
    with monkeypatch.context() as patch:
        patch.setattr(provenance, 'tick_digest', lambda: '0123456789abcdef')
        edited = push(tmp_path / 'edited', {})
    main(['compare', str(bags['one']), str(edited)])
    head, _, line, equal = capsys.readouterr().out.splitlines()
    assert head == 'configuration, scenario or versions differ:'
    assert line.split() == ['version.kernels', provenance.tick_digest(), '0123456789abcdef']
    assert equal.startswith('equal: 21 ticks, ')


def test_a_gain_that_differs_comes_first(
        bags: dict[str, Path], capsys: pytest.CaptureFixture[str]) -> None:
    """Then the first difference, then a line for each topic with its largest deviation."""
    assert compare(bags, 'kp') == 1
    head, columns, key, first, table, *topics = capsys.readouterr().out.splitlines()
    assert head == 'configuration, scenario or versions differ:'
    names = [str(bags['one']), str(bags['kp'])]
    assert columns.split() == ['key', *names, 'unit']
    assert key.split() == [KP, '8e-08', '9e-08', 'm/N']
    assert first.startswith('differ: tick ')
    assert table.split()[:3] == ['topic', 'messages', 'from'] and table.split()[-4:-2] == names
    assert len(topics) > 4
    line = next(topic.split() for topic in topics if topic.startswith('/ram/valve '))
    _, _, _, field, tick, expected, actual, deviation, allowed = line
    assert field in ('position[0]', 'velocity[0]', 'effort[0]', 'position[1]', 'velocity[1]')
    assert 0 < int(tick) <= 20 and allowed == 'none'
    # six digits of each value, three of the deviation
    assert float(deviation) == pytest.approx(
        abs(float(actual) - float(expected)), rel=0.01, abs=1e-5 * abs(float(expected)))


def test_a_bag_beside_itself_is_expected_and_actual() -> None:
    one, other = Path('runs/one'), Path('runs/../runs/one')
    assert names_of_runs(one, other) == ('runs/one', 'runs/../runs/one')
    assert names_of_runs(one, one) == ('expected', 'actual')


def test_a_setpoint_of_the_scenario_is_named(
        bags: dict[str, Path], capsys: pytest.CaptureFixture[str]) -> None:
    assert compare(bags, 'scenario') == 1
    key = capsys.readouterr().out.splitlines()[2]
    assert key.split() == ['scenario.tracks.ram[1].position', '0.051', '0.052']


def test_configurations_may_differ_where_the_messages_are_equal(
        bags: dict[str, Path], capsys: pytest.CaptureFixture[str]) -> None:
    """The exit code is that of the messages."""
    assert compare(bags, 'patient') == 0
    _, _, key, verdict = capsys.readouterr().out.splitlines()
    assert key.split() == ['tick_timeout_s', '5.0', '6.0', 's']
    assert verdict.startswith('equal: ')


def test_a_shorter_run_is_compared_as_far_as_it_goes(
        bags: dict[str, Path], capsys: pytest.CaptureFixture[str]) -> None:
    assert compare(bags, 'shorter') == 1
    key, verdict, _, ticks = capsys.readouterr().out.splitlines()[2:]
    assert key.split() == ['scenario.duration_s', '0.02', '0.015']
    assert verdict == (
        "differ: tick 16 (t = 0.016000 s), bag, tick: expected 'present', got 'absent'")
    assert ticks.split()[:5] == ['bag', '5', '16', 'tick', '16']


def test_the_differences_are_written_as_json(
        bags: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Every digit; nothing differs in equal bags."""
    path = tmp_path / 'differences.json'
    assert compare(bags, 'kp', '--json', str(path)) == 1
    found = json.loads(path.read_text())
    assert found['keys'] == [
        {'key': KP, 'expected': 8e-8, 'actual': 9e-8, 'unit': 'm/N'}]
    assert not found['is_equal']
    topic = next(topic for topic in found['topics'] if topic['topic'] == '/ram/joint_states')
    assert topic['messages'] > 0 and topic['first']['tick'] <= topic['largest']['tick']
    largest = topic['largest']
    assert largest['size'] == abs(largest['actual'] - largest['expected'])
    assert compare(bags, 'same', '--json', str(path)) == 0
    equal = json.loads(path.read_text())
    assert (equal['is_equal'], equal['keys'], equal['topics']) == (True, [], [])
    assert (equal['ticks'], equal['end_ns']) == (21, 20_000_000)


def test_numbers_that_json_lacks_are_text(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bags = {name: record(tmp_path / name, 2, {1: {'spool': value}})
            for name, value in (('one', 1.0), ('other', float('nan')))}
    path = tmp_path / 'differences.json'
    assert compare(bags, 'other', '--json', str(path)) == 1
    largest = json.loads(path.read_text())['topics'][0]['largest']
    assert (largest['actual'], largest['size']) == ('nan', 'inf')


def test_a_tolerance_is_shown_beside_the_deviation_beyond_it(
        bags: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Fields within their tolerance are not; what is admitted everywhere is equal."""
    path = tmp_path / 'tolerances.yaml'
    path.write_text('/ram/joint_states: {effort: 1.0e-3}\n')
    compare(bags, 'kp', '--tolerance', str(path))
    lines = {line.split()[0]: line.split() for line in capsys.readouterr().out.splitlines()}
    assert lines['/ram/load_cell'][-1] == 'none'
    wide = '{position: 1.0e+9, velocity: 1.0e+9, effort: 1.0e+9}'
    path.write_text('\n'.join(
        [f'/ram/{topic}: {wide}' for topic in ('joint_states', 'valve', 'references')]
        + [f'/ram/pressure_{chamber}: {{fluid_pressure: 1.0e+9}}' for chamber in 'ab']
        + ['/ram/load_cell: {wrench.force.x: 0.0625}']))
    assert compare(bags, 'kp', '--tolerance', str(path)) == 1
    line = capsys.readouterr().out.splitlines()[-1].split()
    assert (line[0], line[-1]) == ('/ram/load_cell', '0.0625')


def test_bags_of_other_recorders_have_no_configuration(
        bags: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """That is no equality of configurations."""
    valve = dict(tick_messages(0))[NAMES.index('/hip/valve')]
    for name in ('one', 'other'):
        foreign(tmp_path / f'{name}.mcap', ('sensor_msgs/msg/JointState', valve))
    others = {name: tmp_path / f'{name}.mcap' for name in ('one', 'other')}
    assert compare(others, 'other') == 0
    assert capsys.readouterr().out.splitlines()[0] == (
        'both without configuration: comparing the messages only')
    assert compare({'one': bags['one'], 'other': others['other']}, 'other') == 1
    assert capsys.readouterr().out.splitlines()[2].split() == ['provenance', 'present', 'absent']


@pytest.mark.parametrize('text, problem', [
    ('{{{', 'line 2: did not find expected'), ('- 1\n', 'must be sections of `key: value`'),
    ('record: {thinning: 3}\n', '')])
def test_messages_are_compared_without_a_configuration(
        bags: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str,
        problem: str) -> None:
    """Of a version to come, or damaged by hand; each message is still that of the first bag."""
    other = rewrite(Bag(bags['one']), tmp_path / 'other', configuration=lambda _: text)
    code = compare({'one': bags['one'], 'other': other}, 'other', '--json', str(tmp_path / 'j'))
    first, *_, last = capsys.readouterr().out.splitlines()
    assert code == 0 and last.startswith('equal: ')
    assert (problem in first and first.endswith('; comparing the messages only')) if problem else (
        first == 'configuration, scenario or versions differ:')
    found = json.loads((tmp_path / 'j').read_text())['problem']
    assert (problem in found) if problem else found is None


def test_a_message_that_differs_is_found_without_a_configuration(
        bags: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    other = rewrite(
        Bag(bags['one']), tmp_path / 'other', configuration=lambda _: '[',
        change=lambda topic, sequence, data: None if sequence == 3 and topic == '/ram/valve'
        else data)
    assert compare({'one': bags['one'], 'other': other}, 'other') == 1
    assert any(line.startswith('/ram/valve ') for line in capsys.readouterr().out.splitlines())
