"""`assert_reproduces`: a user's files and controllers of today against a bag."""

from collections.abc import Callable, Mapping
import math
from pathlib import Path
import re
import shutil
from typing import Any

import isa_ros
from isa_ros import testing
from isa_ros.bag.provenance import installed_versions
from isa_ros.bag.reader import Bag
from isa_ros.config.models import catalogue
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.text.yaml_text import dump
from isa_ros.controller import Controller, Setpoint, State
from isa_ros.errors import BagError, ConfigError, SimulationDiverged
from isa_ros.testing import assert_replays, assert_reproduces
import pytest
from tests.bag.golden import rewrite

STEP: dict[str, Any] = {'name': 'push', 'duration_s': 0.03, 'tracks': {'ram': [
    {'t_s': 0.0, 'position': 0.05, 'stiffness': 1.0e5, 'damping': 1.0e3},
    {'t_s': 0.01, 'position': 0.051}]}}
KP = re.compile(r'(?<=  default:\n    force:\n      kp: \{value: )[0-9.e-]+')
"""The force gain of the preset in the shipped model."""


class Project:
    """A directory with a run file, a scenario, and the bag that they gave."""

    def __init__(self, directory: Path) -> None:
        self.config, self.scenario = directory / 'my_ram.yaml', directory / 'push.yaml'
        shutil.copy(find('rig_linear', CONFIG), self.config)
        self.scenario.write_text(dump(STEP))
        self.bag = self.run().simulate().save(directory / 'bag')

    def run(self) -> isa_ros.Run:
        return isa_ros.load(self.config, self.scenario)

    def failure(self, **more: Any) -> list[str]:
        """Return the lines of the message with which the bag is not reproduced."""
        with pytest.raises(AssertionError) as caught:
            assert_reproduces(self.config, self.scenario, self.bag, **more)
        return str(caught.value).splitlines()

    def write(self, path: Path, change: Callable[[str], str]) -> None:
        """Change the text of a file."""
        text = path.read_text()
        assert change(text) != text
        path.write_text(change(text))


@pytest.fixture
def project(tmp_path: Path) -> Project:
    return Project(tmp_path)


def test_files_that_did_not_change_give_the_bag_byte_for_byte(project: Project) -> None:
    """Without tolerances; the files as paths, or their content."""
    assert_reproduces(project.config, project.scenario, project.bag)
    assert_reproduces(str(project.config), STEP, str(project.bag))
    saved = project.run().simulate().save(project.bag.parent / 'again')
    assert next(saved.glob('*.mcap')).read_bytes() == next(
        project.bag.glob('*.mcap')).read_bytes()


def test_a_gain_of_the_model_is_named_and_leaves_the_replay_green(
        project: Project, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A replay simulates the configuration in the bag, so only the new assertion can fail."""
    models = tmp_path / 'models'
    shutil.copytree(catalogue._MODELS, models)
    before = float(KP.findall((models / 'isa_v5.yaml').read_text())[0])
    after = 1.125 * before
    project.write(models / 'isa_v5.yaml', lambda text: KP.sub(repr(after), text))
    monkeypatch.setattr(catalogue, '_MODELS', models)
    head, differ, _, key, first, *_ = project.failure()
    assert head == f'{project.bag}: not reproduced by my_ram.yaml, scenario push'
    assert differ == 'configuration, scenario or versions differ:'
    assert key.split() == [
        'actuators.ram.parameters.reu.force.kp', repr(before), repr(after), 'm/N']
    assert first.startswith('differ: tick ')
    assert_replays(project.bag)


def test_every_topic_that_deviates_has_field_tick_values_and_tolerance(
        project: Project, tmp_path: Path) -> None:
    project.write(project.config, lambda text: text.replace(
        'preset: default', 'preset: default, parameters: {reu: {force: {kp: 9.0e-8}}}'))
    tolerances = tmp_path / 'tolerances.yaml'
    tolerances.write_text('/ram/load_cell: {wrench.force.x: 0.0625}\n')
    lines = project.failure(tolerances=tolerances)
    table = next(k for k, line in enumerate(lines) if line.startswith('topic '))
    assert lines[table].split() == [
        'topic', 'messages', 'from', 'tick', 'largest', 'deviation', 'tick', 'in', 'the', 'bag',
        'now', 'deviation', 'allowed']
    _, _, _, field, tick, there, now, deviation, allowed = next(
        line.split() for line in lines if line.startswith('/ram/load_cell '))
    assert (field, allowed) == ('wrench.force.x', '0.0625')
    assert 0 < int(tick) <= 30
    changed = project.run().simulate()
    assert float(now) == pytest.approx(changed['ram.force'][int(tick)], rel=1e-5, abs=1e-5)
    assert float(deviation) == pytest.approx(abs(float(now) - float(there)), rel=0.01, abs=1e-3)


def test_deviations_within_their_tolerances_pass(project: Project, tmp_path: Path) -> None:
    """A bound on every signal, as for other versions."""
    project.write(project.config, lambda text: text.replace(
        'preset: default', 'preset: default, parameters: {reu: {force: {kp: 8.0000001e-8}}}'))
    wide = '{position: 1.0, velocity: 1.0, effort: 10.0}'
    tolerances = tmp_path / 'tolerances.yaml'
    tolerances.write_text(''.join(
        [f'/ram/{topic}: {wide}\n' for topic in ('joint_states', 'valve')]
        + ['/ram/references: {position: 10.0}\n', '/ram/load_cell: {wrench.force.x: 10.0}\n']
        + [f'/ram/pressure_{chamber}: {{fluid_pressure: 1.0e+5}}\n' for chamber in 'ab']))
    assert_reproduces(project.config, project.scenario, project.bag, tolerances)
    assert project.failure()[3].split()[0] == 'actuators.ram.parameters.reu.force.kp'


def test_a_scenario_that_changed_is_named(project: Project) -> None:
    project.write(project.scenario, lambda text: text.replace('0.051', '0.052'))
    assert project.failure()[3].split() == [
        'scenario.tracks.ram[1].position', '0.051', '0.052']
    assert_replays(project.bag)


@pytest.mark.parametrize(('duration', 'n', 'verb'), [
    ('0.02', 10, ['present', 'absent']), ('0.04', 10, ['absent', 'present'])])
def test_a_shorter_and_a_longer_run_are_told(
        project: Project, duration: str, n: int, verb: list[str]) -> None:
    project.write(project.scenario, lambda text: text.replace('duration_s: 0.03',
                                                              f'duration_s: {duration}'))
    lines = project.failure()
    assert lines[3].split() == ['scenario.duration_s', '0.03', duration]
    ticks = next(line.split() for line in lines if line.startswith('bag '))
    assert ticks[1] == str(n) and ticks[5:] == verb
    assert not [line for line in lines[1:] if line.startswith('/')]


def test_the_duration_of_a_run_that_was_given_one_is_given_again(project: Project) -> None:
    """`isa bringup --duration`: neither file has it."""
    bag = isa_ros.load(project.config, project.scenario, duration=0.02).simulate().save(
        project.bag.parent / 'short')
    assert_reproduces(project.config, project.scenario, bag, duration=0.02)
    with pytest.raises(AssertionError, match='scenario.duration_s +0.02 +0.03'):
        assert_reproduces(project.config, project.scenario, bag)


def test_a_run_without_scenario_lasts_as_long_as_its_bag(project: Project) -> None:
    bag = isa_ros.load(project.config).simulate(0.01).save(project.bag.parent / 'idle')
    assert_reproduces(project.config, None, bag)


def test_a_topic_that_is_not_recorded_any_more_is_missing(project: Project) -> None:
    project.write(project.config, lambda text: f'{text}record: {{leave_out: [/ram/valve]}}\n')
    lines = project.failure()
    assert lines[3].split() == ['record.leave_out', '[]', '[/ram/valve]']
    topic, = (line.split() for line in lines[1:] if line.startswith('/'))
    assert topic[:3] == ['/ram/valve', '31', '0'] and topic[-2:] == ['present', 'absent']


def test_a_topic_that_the_bag_lacks_is_too_many(project: Project) -> None:
    bag = rewrite(Bag(project.bag), project.bag.parent / 'less', without=('/ram/valve',))
    with pytest.raises(AssertionError, match='/ram/valve +31 +0 +message +0 +absent +present'):
        assert_reproduces(project.config, project.scenario, bag)


class Sway(Controller):
    """Moves the ram as a sine."""

    def __init__(self, amplitude: float = 1e-3) -> None:
        self._amplitude = amplitude

    def step(self, state: State) -> Mapping[str, Setpoint]:
        return {'ram': Setpoint(position=0.05 + self._amplitude * math.sin(1e-8 * state.t_ns))}


def test_a_controller_that_changed_is_found(project: Project) -> None:
    """No file differs, so the message says that controllers are not in the bag."""
    bag = project.bag.parent / 'sway'
    project.run().simulate(controllers=[Sway()]).save(bag)
    assert_reproduces(project.config, project.scenario, bag, controllers=[Sway()])
    with pytest.raises(AssertionError) as caught:
        assert_reproduces(project.config, project.scenario, bag, controllers=[Sway(2e-3)])
    lines = str(caught.value).splitlines()
    assert lines[1] == 'configuration, scenario and versions are equal'
    assert '/ram/applied_setpoint' in [line.split()[0] for line in lines]
    assert 'Controllers and external bodies are not stored in a bag' in lines[-1]
    assert_replays(bag)


def test_a_controller_that_is_missing_is_named(project: Project) -> None:
    bag = project.bag.parent / 'sway'
    project.run().simulate(controllers=[Sway()]).save(bag)
    with pytest.raises(AssertionError, match=r'controllers +\[sway\] +\[\]'):
        assert_reproduces(project.config, project.scenario, bag)


def test_a_run_that_diverges_says_what_changed_first(
        project: Project, monkeypatch: pytest.MonkeyPatch) -> None:
    def diverge(*_: object) -> None:
        raise SimulationDiverged(7_000_000, 'plant.chambers.p_a', math.inf)

    project.write(project.scenario, lambda text: text.replace('0.051', '0.052'))
    monkeypatch.setattr(testing, 'simulated', diverge)
    lines = project.failure()
    assert lines[3].split()[0] == 'scenario.tracks.ram[1].position'
    assert lines[4:] == [str(SimulationDiverged(7_000_000, 'plant.chambers.p_a', math.inf))]


def test_versions_are_among_what_differs(project: Project) -> None:
    there = installed_versions() | {'numpy': '1.0'}
    bag = rewrite(Bag(project.bag), project.bag.parent / 'other', versions=there)
    assert_reproduces(project.config, project.scenario, bag)
    project.write(project.scenario, lambda text: text.replace('0.051', '0.052'))
    with pytest.raises(AssertionError, match='version.numpy +1.0 '):
        assert_reproduces(project.config, project.scenario, bag)


def test_what_cannot_be_run_is_refused_in_one_line(project: Project, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match='^no_such_ram.yaml: no such file'):
        assert_reproduces('no_such_ram.yaml', None, project.bag)
    with pytest.raises(BagError, match='no such bag'):
        assert_reproduces(project.config, project.scenario, tmp_path / 'none')


def test_a_bag_that_continues_a_saved_state_is_refused(project: Project) -> None:
    """Files say nothing of the state that it began with."""
    bag = rewrite(Bag(project.bag), project.bag.parent / 'later', state='{}')
    with pytest.raises(BagError, match='later: continues a saved state, must be a run from t = 0'):
        assert_reproduces(project.config, project.scenario, bag)
