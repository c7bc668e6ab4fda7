"""Bags of other versions: differences are listed, then the run is simulated if possible."""

from importlib.metadata import version
from pathlib import Path
import re

from isa_ros.bag import provenance, writer
from isa_ros.bag.provenance import installed_versions, KERNELS, PYTHON, VERSION
from isa_ros.bag.reader import Bag
from isa_ros.bag.storage import Storage
from isa_ros.bag.writer import BagWriter
from isa_ros.cli.main import main
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.replay.installation import _changed_versions, differences
from isa_ros.replay.replay import Rerun
from isa_ros.run.provenance import recorded_versions
from msg_adapters.definitions import Definition, definition
import pytest
from tests.bag.golden import GOLDEN, rewrite
from tests.bag.recorded import record

VALVE = 'sensor_msgs/msg/JointState'
RIG_TEXT = load_run(Path(__file__).parents[2] / 'config' / 'rig_rotary.yaml').to_yaml()


@pytest.fixture(scope='module')
def here(tmp_path_factory) -> Bag:
    """Return a bag that this machine recorded with these versions: a golden run anew."""
    directory = tmp_path_factory.mktemp('here') / 'rig'
    golden = Bag(GOLDEN / 'rotor_step')
    again = Rerun(golden)
    configuration = run_of_text(golden.provenance.configuration).to_yaml()
    own = provenance.Provenance(
        configuration, golden.provenance.scenario, 0, installed_versions())
    with BagWriter(directory, again.topics, own) as writer:
        again.simulate(writer)
    return Bag(directory)


@pytest.fixture
def replayed(capsys):
    """Return the result of `isa replay` of a bag: exit code, output lines, errors."""
    def replay(bag: Path) -> tuple[int, list[str], str]:
        code = main(['replay', str(bag)])
        printed = capsys.readouterr()
        assert printed.err.count('\n') == (code > 1)
        return code, printed.out.splitlines(), printed.err
    return replay


def edited(pattern: str, replacement: str):
    """Return a replacement in a configuration that must occur there."""
    def change(text: str) -> str:
        changed, count = re.subn(pattern, replacement, text, count=1, flags=re.MULTILINE)
        assert count == 1
        return changed
    return change


def test_bag_of_this_installation_differs_in_nothing(here, replayed):
    assert differences(here) == []
    assert replayed(here.path.parent) == (
        0, [f'equal: 151 ticks, {here.n_messages} messages, up to t = 0.150000 s'], '')


def test_other_versions_are_said_first_and_simulated(here, replayed, tmp_path):
    """Some versions differ here, one was not recorded, and one is unknown."""
    there = installed_versions() | {'numpy': '1.0', 'numba': '0.1', 'fortran': '77'}
    del there['llvmlite']
    bag = rewrite(here, tmp_path / 'old', versions=there)
    code, lines, _ = replayed(bag)
    assert code == 0
    assert lines[:-1] == [
        'fortran is not known here, was 77',
        f'numba is {version("numba")} here, was 0.1',
        f'numpy is {version("numpy")} here, was 1.0',
        f'llvmlite is {version("llvmlite")} here, was not recorded']
    assert lines[-1].startswith('equal: 151 ticks')


def test_other_format_of_the_provenance_is_not_simulated(replayed, tmp_path, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(provenance, 'FORMAT', '2')
        BagWriter(tmp_path / 'new', [], provenance.Provenance(
            RIG_TEXT, '', 0, installed_versions())).close()
    code, lines, error = replayed(tmp_path / 'new')
    assert code == 2
    assert lines == ["the format of the provenance is '2', here '1'"]
    assert 'cannot be simulated by this version: the format of the provenance' in error


def test_key_that_is_unknown_here_is_named_and_not_simulated(here, replayed, tmp_path):
    bag = rewrite(here, tmp_path / 'new', configuration=edited(
        r'^( +)kf: (.*)$', r'\1kf: \2\n\1magic: 1.0'))
    code, lines, error = replayed(bag)
    expected = 'configuration.yaml: actuators.rotor.sheet.reu.force.magic is unknown here'
    assert (code, lines) == (2, [expected])
    assert error == (
        f'isa: {bag / "new_0.mcap"}: cannot be simulated by this version: {expected}; `isa '
        'report` and isa_ros.read show what it recorded\n')


def test_what_is_harmless_is_not_said_of_a_bag_that_cannot_be_simulated(
        here, replayed, tmp_path):
    """Keys of several actuators are one line; lines are sorted."""
    def older(text: str) -> str:
        text = edited(r'^seed: 0\n', '')(text)     # harmless
        text = edited(r'^( +)kf: (.*)$', r'\1kf: \2\n\1wonder: 2.0\n\1magic: 1.0')(text)
        return edited(r'^  rotor:\n((?:    .*\n)+)', r'  left:\n\1  rotor:\n\1')(text)
    code, lines, error = replayed(rewrite(here, tmp_path / 'old', configuration=older))
    assert (code, lines) == (2, [
        'configuration.yaml: actuators.*.sheet.reu.force.magic is unknown here (2 times)',
        'configuration.yaml: actuators.*.sheet.reu.force.wonder is unknown here (2 times)'])
    assert 'wonder is unknown here (2 times); `isa report` and isa_ros.read' in error


def test_key_that_the_bag_lacks_is_named_and_not_simulated(here, replayed, tmp_path):
    bag = rewrite(here, tmp_path / 'old', configuration=edited(r'^ +kf: .*\n', ''))
    code, lines, error = replayed(bag)
    expected = 'configuration.yaml: actuators.rotor.sheet.reu.force.kf is missing in the bag'
    assert (code, lines) == (2, [expected])
    assert expected in error


def test_sections_that_came_later_are_said_and_simulated(here, replayed, tmp_path):
    def before(text: str) -> str:
        for section in ('record', 'controllers'):
            text, count = re.subn(rf'^{section}:.*\n(?: +.*\n)*', '', text, flags=re.MULTILINE)
            assert count == 1
        return text

    code, lines, _ = replayed(rewrite(here, tmp_path / 'old', configuration=before))
    assert code == 0
    assert lines[:-1] == [
        'configuration.yaml: record is missing in the bag, everything is meant',
        'configuration.yaml: controllers is missing in the bag, none is meant']


def test_kind_that_is_unknown_here_is_named(here, replayed, tmp_path):
    bag = rewrite(here, tmp_path / 'new', configuration=edited('kind: blocked', 'kind: ghost'))
    code, lines, _ = replayed(bag)
    assert (code, lines) == (
        2, ["configuration.yaml: actuators.rotor.load: the kind 'ghost' is unknown here"])


def test_every_difference_has_its_line_and_the_error_names_three(here, replayed, tmp_path):
    keys = ''.join(f'new_{k}: 1\n' for k in range(5))
    bag = rewrite(here, tmp_path / 'new', configuration=lambda text: text + keys)
    code, lines, error = replayed(bag)
    assert (code, len(lines)) == (2, 5)
    assert 'new_2 is unknown here; and 2 more; `isa report`' in error


def test_topic_that_the_bag_lacks_is_said_and_the_rest_compared(here, replayed, tmp_path):
    bag = rewrite(here, tmp_path / 'old', without=('/rotor/valve',))
    code, lines, _ = replayed(bag)
    assert code == 0
    assert lines[0] == '/rotor/valve is missing in the bag'
    assert lines[1].startswith(f'equal: 151 ticks, {here.n_messages - 151} messages')


def test_topic_that_is_unknown_here_is_said_and_leaves_the_answer_no(here, replayed, tmp_path):
    """The bag's messages of this topic were not reproduced."""
    bag = rewrite(here, tmp_path / 'new', rename={'/rotor/valve': '/rotor/ghost'})
    code, lines, _ = replayed(bag)
    assert code == 1
    assert lines[:2] == [
        '/rotor/ghost is unknown here, so it is not compared',
        '/rotor/valve is missing in the bag']
    assert lines[2].startswith('not confirmed: /rotor/ghost; the rest is equal: 151 ticks')


def test_topic_of_another_type_is_not_compared(here, replayed, tmp_path):
    bag = rewrite(here, tmp_path / 'new', rename={
        '/rotor/valve': '/rotor/pressure_a', '/rotor/pressure_a': '/rotor/valve'})
    code, lines, _ = replayed(bag)
    assert code == 1
    assert lines[0] == (
        '/rotor/pressure_a is sensor_msgs/msg/JointState in the bag, '
        'sensor_msgs/msg/FluidPressure here, so it is not compared')


def test_topic_of_another_definition_is_not_compared(here, replayed, tmp_path, monkeypatch):
    """For example with one more field: the name is the same, its definition has another hash."""
    other = Definition(definition(VALVE).text, 'RIHS01_' + '0' * 64)
    with monkeypatch.context() as patch:
        patch.setattr(writer, 'definition', lambda name: (
            other if name == VALVE else definition(name)))
        bag = rewrite(here, tmp_path / 'new')
    code, lines, _ = replayed(bag)
    assert code == 1
    assert lines[0] == (
        f'/rotor/applied_setpoint is another {VALVE} in the bag than here, so it is not compared')
    assert lines[-1].startswith('not confirmed: /rotor/applied_setpoint, /rotor/joint_states, ')


def test_file_of_a_split_bag_is_not_replayed_alone(replayed, tmp_path):
    record(tmp_path / 'rig', 600, storage=Storage(compression='none', split_mb=0.001))
    code, lines, error = replayed(tmp_path / 'rig' / 'rig_1.mcap')
    assert (code, lines) == (2, [])
    assert 'rig_1.mcap: is file 1 of a split bag, replay its directory' in error


def test_split_and_compressed_bag_replays(here, replayed, tmp_path):
    bag = rewrite(here, tmp_path / 'rig', storage=Storage(compression='lz4', split_mb=0.001))
    assert replayed(bag)[0] == 0


def test_a_patch_release_of_python_is_no_difference():
    """It changes no number; bags of before have it."""
    here = installed_versions()
    record = {f'{VERSION}{name}': version for name, version in here.items()}
    assert list(_changed_versions(record | {f'{VERSION}{PYTHON}': f'{here[PYTHON]}.99'})) == []
    assert list(_changed_versions(record | {f'{VERSION}{PYTHON}': '2.7.18'})) == [
        f'python is {here[PYTHON]} here, was 2.7']


def test_other_kernels_are_one_line_if_they_can_be_compared(here, replayed, tmp_path):
    """Bags of before have no digest of kernels, and another Python has another one."""
    own = recorded_versions()
    for name, change, expected in (
            ('edited', {KERNELS: 'f' * 16}, [f'{KERNELS} is {own[KERNELS]} here, was {"f" * 16}']),
            ('python', {KERNELS: 'f' * 16, PYTHON: '3.7'},
             [f'python is {own[PYTHON]} here, was 3.7']),
            ('same', {}, [])):
        code, lines, _ = replayed(rewrite(here, tmp_path / name, versions=own | change))
        assert (code, lines[:-1]) == (0, expected)
    assert KERNELS not in here.provenance.versions
    assert replayed(here.path.parent)[1][:-1] == []
