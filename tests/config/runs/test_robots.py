"""Several robots from run files of their own: their names, what they share, what is refused."""

from pathlib import Path
from typing import Any

import isa_ros
from isa_ros.config.listing import describe
from isa_ros.config.paths import CONFIG, find, find_drawing
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import dump, read
from isa_ros.errors import ConfigError
from isa_ros.scenario.scenario import read_scenario, scenario_of
import pytest

PUMP = {'kind': 'constant', 'pressure_mpa': 16.0, 'return_pressure_mpa': 0.0}
RAM = {'model': 'isa_v5', 'load': {'kind': 'mass'}}
BOTH = ('r1', 'r2')


def pair(**others: Any) -> dict[str, Any]:
    """Return a run file of two legs, with other keys."""
    return {'name': 'pair', 'robots': {name: {'file': 'leg'} for name in BOTH}} | others


def of(tree: dict[str, Any]) -> RunConfig:
    return isa_ros.load(tree).configuration


def legs(**second: Any) -> dict[str, Any]:
    """Return two legs, the second one with other values."""
    return pair(robots={'r1': {'file': 'leg'}, 'r2': {'file': 'leg', **second}})


def test_all_parts_of_a_robot_are_in_its_namespace():
    run, leg = of(pair()), of(read(find('leg', CONFIG)))
    joints = [own.name for own in leg.actuators]
    assert [own.name for own in run.actuators] == [f'{r}/{j}' for r in BOTH for j in joints]
    assert [own.sheet for own in run.actuators] == 2 * [own.sheet for own in leg.actuators]
    assert [own.name for own in run.bodies] == list(BOTH)
    assert [own.prefix for own in run.bodies] == ['r1/', 'r2/']
    assert [dict(own.joints)['kfe'] for own in run.bodies] == ['r1/kfe', 'r2/kfe']
    assert [(own.name, own.feeds) for own in run.supplies] == [
        (f'{r}/supply', tuple(f'{r}/{j}' for j in joints)) for r in BOTH]
    assert [(own.name, own.actuators) for own in run.emergency_stops] == [
        (r, tuple(f'{r}/{j}' for j in joints)) for r in BOTH]
    assert run.name == 'pair' and run.source == 'pair.yaml'
    assert run_of_text(run.to_yaml()) == run


def test_a_robot_has_other_values_by_the_keys_of_its_file():
    """A value of the run file wins over that of the file, and --set over both."""
    tree = legs(leg={'start': {'foot_height_mm': 50.0}}, supply={'pressure_mpa': 14.0},
                actuators={'kfe': {'parameters': {'plant': {'friction': {'stiction': 90.0}}}}})
    run = isa_ros.load(tree, changes={'robots.r2.supply.pressure_mpa': 13.0}).configuration
    first, second = run.bodies
    assert (first.start.foot_height_mm, second.start.foot_height_mm) == (0.0, 50.0)
    stiction = [own.sheet.plant.friction.stiction for own in run.actuators]
    assert stiction[3:] == [*stiction[:2], 90.0] and stiction[2] != 90.0
    assert [own.sheet.pressure_mpa for own in run.supplies] == [20.7, 13.0]


def test_a_section_of_another_kind_replaces_that_of_the_file(tmp_path: Path):
    (tmp_path / 'ram.yaml').write_text(dump({
        'name': 'ram', 'supply': PUMP, 'actuators': {'ram': {
            'model': 'isa_v5', 'load': {'kind': 'mass', 'inertia': 40.0}}}}))
    (tmp_path / 'two.yaml').write_text(dump({'name': 'two', 'robots': {
        'heavy': {'file': 'ram.yaml'},
        'fixed': {'file': 'ram.yaml', 'actuators': {'ram': {'load': {'kind': 'blocked'}}}}}}))
    heavy, fixed = isa_ros.load(tmp_path / 'two.yaml').configuration.actuators
    assert (heavy.name, heavy.load.inertia) == ('heavy/ram', 40.0)
    assert type(fixed.load) is not type(heavy.load)


def test_one_supply_of_the_run_file_feeds_all():
    run = of(pair(supply=PUMP))
    assert [(own.name, len(own.feeds)) for own in run.supplies] == [('supply', 6)]


def test_a_supply_of_the_run_file_feeds_those_that_it_names():
    """The others stay on their own, and a supply that feeds none is left out."""
    knees = {'knees': PUMP | {'feeds': ['r1/kfe', 'r2/kfe']}}
    assert {own.name: own.feeds for own in of(pair(supplies=knees)).supplies} == {
        'knees': ('r1/kfe', 'r2/kfe'), 'r1/supply': ('r1/haa', 'r1/hfe'),
        'r2/supply': ('r2/haa', 'r2/hfe')}
    first = {'first': PUMP | {'feeds': ['r1/haa', 'r1/hfe', 'r1/kfe']}}
    assert [own.name for own in of(pair(supplies=first)).supplies] == ['first', 'r2/supply']


def test_a_run_has_actuators_beside_its_robots():
    """They are a group of emergency stops of the run's name."""
    run = of(pair(supplies={'pump': PUMP | {'feeds': ['ram']}}, actuators={'ram': RAM}))
    assert [own.name for own in run.actuators][:2] == ['ram', 'r1/haa']
    assert [own.name for own in run.emergency_stops] == ['pair', 'r1', 'r2']
    assert run.emergency_stops[0].actuators == ('ram',)


def test_groups_of_a_robot_are_in_its_namespace_and_those_of_the_run_stand_for_all():
    knee = {'knee': {'actuators': ['kfe'], 'reactions': ['block']}}
    run = of(legs(emergency_stops=knee))
    assert [(own.name, own.actuators) for own in run.emergency_stops][1:] == [
        ('r2/knee', ('r2/kfe',))]
    own, = of(legs(emergency_stops=knee) | {'emergency_stops': {'every': {}}}).emergency_stops
    assert own.name == 'every' and len(own.actuators) == 6


def test_a_link_of_the_run_lies_below_the_links_of_actuators():
    """Of robots and of its own actuators alike; other keys are those of the run."""
    lossy = {'actuators': {'kfe': {'link': {'loss': 0.25}}}}
    tree = legs(**lossy) | {
        'link': {'kind': 'ethercat', 'cycle_ms': 1.0, 'loss': 0.5}, 'supply': PUMP,
        'actuators': {'ram': RAM | {'link': {'loss': 0.125}}, 'rod': RAM}}
    links = {own.name: own.sheet.link for own in of(tree).actuators}
    assert {name: own.loss for name, own in links.items()} == {
        'ram': 0.125, 'rod': 0.5, 'r1/haa': 0.5, 'r1/hfe': 0.5, 'r1/kfe': 0.5, 'r2/haa': 0.5,
        'r2/hfe': 0.5, 'r2/kfe': 0.25}
    assert {own.kind for own in links.values()} == {'ethercat'}


def test_what_belongs_to_the_run_is_that_of_the_robots_or_given(tmp_path: Path):
    leg = read(find('leg', CONFIG))
    for name, step in (('slow', 2.0), ('quick', 0.5)):
        (tmp_path / f'{name}.yaml').write_text(dump(leg | {
            'step_ms': step, 'controller_offset_ms': 0.8 * step, 'seed': 3, 'accept': 'scenario'}))

    def run(others: str, **keys: Any) -> RunConfig:
        (tmp_path / 'two.yaml').write_text(dump({'name': 'two', 'robots': {
            'r1': {'file': 'slow.yaml'}, 'r2': {'file': others}}, **keys}))
        return isa_ros.load(tmp_path / 'two.yaml').configuration
    assert (run('slow.yaml').step_ns, run('slow.yaml').seed) == (2_000_000, 3)
    assert run('slow.yaml').accept == 'scenario'
    assert run('slow.yaml').controller_offset_ns == 1_600_000
    assert run('slow.yaml', seed=5).seed == 5
    given = run('quick.yaml', step_ms=1.0, controller_offset_ms=0.4)
    assert (given.step_ns, given.controller_offset_ns) == (1_000_000, 400_000)
    with pytest.raises(ConfigError, match=(
            'two.yaml: robots: step_ns = 2000000 of r1 and 500000 of r2, must be one for all; '
            'give step_ms in two.yaml')):
        run('quick.yaml')


@pytest.mark.parametrize(('tree', 'message'), [
    (pair(robots={}), 'pair.yaml: robots is empty, must name at least one robot'),
    (pair(robots={'R1': {'file': 'leg'}}), "pair.yaml: robots.R1: the name = 'R1', must be small"),
    (pair(robots={'a/b': {'file': 'leg'}}), "the name = 'a/b', must be small letters"),
    (pair(robots={'coordinator': {'file': 'leg'}}), 'the namespace is reserved for the coord'),
    (pair(robots={'r1': {}}), 'pair.yaml: robots.r1 lacks file'),
    (pair(robots={'r1': 'leg'}), "robots.r1 = 'leg', must be a section"),
    (pair(robots={'r1': {'file': 3}}), 'robots.r1.file = 3, must be the name of a file'),
    (pair(robots={'r1': {'file': 'log'}}), 'pair.yaml: robots.r1.file: log: no such file; did'),
    (legs(step_ms=2.0), 'pair.yaml: robots.r2.step_ms is unknown'),
    (legs(actuators={'kfe': {'preset': 'no'}}),
     "pair.yaml: robots.r2.actuators.kfe.preset = 'no'"),
    (pair(actuators={'r1/kfe': RAM}), 'pair.yaml: actuators.r1/kfe: the name is that of a part '
     'of a robot; other values of it stand below robots'),
    (pair(bodies={'r1': {'kind': 'external', 'actuators': ['r1/kfe']}}), 'bodies.r1: the name is'),
    (pair(supplies={'r2/supply': PUMP | {'feeds': []}}), 'supplies.r2/supply: the name is'),
    (pair(actuators={'ram': RAM}), "pair.yaml: supplies: 'ram' is not fed"),
    (pair(supply=PUMP, actuators={'r1_kfe': RAM}), "'r1_kfe' and 'r1/kfe' must differ in more"),
    (pair(supply=PUMP, actuators={'ram': RAM}, bodies={
        'r1_kfe': {'kind': 'external', 'actuators': ['ram']}}),
     "'r1/kfe' and 'r1_kfe' must differ in more"),
    (pair(bodies={'coordinator': {'kind': 'external', 'actuators': ['r1/kfe']}}),
     "bodies.coordinator: the name 'coordinator' is taken"),
])
def test_a_refusal_names_file_key_and_robot(tree, message):
    with pytest.raises(ConfigError) as error:
        of(tree)
    assert message in str(error.value)


def test_a_robot_with_other_values_has_the_files_beside_its_own(tmp_path: Path):
    """Its URDF stands in the folder of its run file, not in that of the run."""
    (tmp_path / 'own').mkdir()
    (tmp_path / 'own' / 'my.urdf').write_text(find_drawing('urdf/two_joint_leg.urdf').read_text())
    hopper = read(find('two_joint_leg', CONFIG))
    hopper['body']['urdf'] = 'my.urdf'  # type: ignore[index, call-overload]
    (tmp_path / 'own' / 'hopper.yaml').write_text(dump(hopper))
    (tmp_path / 'two.yaml').write_text(dump(pair(robots={
        'r1': {'file': 'own/hopper.yaml'},
        'r2': {'file': 'own/hopper.yaml', 'supply': {'pressure_mpa': 16.0}}})))
    run = isa_ros.load(tmp_path / 'two.yaml').configuration
    assert run.bodies[0].tree == run.bodies[1].tree
    assert [own.sheet.pressure_mpa for own in run.supplies] == [20.7, 16.0]


def test_what_is_wrong_in_the_file_of_a_robot_has_its_name(tmp_path: Path):
    (tmp_path / 'broken.yaml').write_text(dump(
        read(find('leg', CONFIG)) | {'leg': {'model': 'hyq_real'}}))
    (tmp_path / 'two.yaml').write_text(dump(pair(robots={'r1': {'file': 'broken.yaml'}})))
    with pytest.raises(ConfigError, match='^broken.yaml: leg lacks joints'):
        isa_ros.load(tmp_path / 'two.yaml')
    (tmp_path / 'two.yaml').write_text(dump(pair(robots={'r1': {'file': 'two.yaml'}})))
    with pytest.raises(ConfigError, match='^two.yaml: robots is not used here: a robot has no'):
        isa_ros.load(tmp_path / 'two.yaml')


def test_names_with_a_namespace_need_no_robots():
    run = of({'name': 'rigs', 'supply': PUMP, 'actuators': {'left/ram': RAM, 'right/ram': RAM}})
    assert [own.name for own in run.actuators] == ['left/ram', 'right/ram']
    with pytest.raises(ConfigError, match="the name = 'a/b/c', .*; or NAMESPACE/NAME"):
        of({'name': 'rigs', 'supply': PUMP, 'actuators': {'a/b/c': RAM}})
    with pytest.raises(ConfigError, match='reserved for the coordinator'):
        of({'name': 'rigs', 'supply': PUMP, 'actuators': {'coordinator/ram': RAM}})


def test_the_table_of_a_run_has_the_sources_of_its_robots(tmp_path: Path):
    (tmp_path / 'pair.yaml').write_text(dump(legs(supply={'pressure_mpa': 14.0})))
    texts = describe(str(tmp_path / 'pair.yaml')), describe('leg')
    own, leg = ({text.splitlines()[0]: text.splitlines()[1:] for text in one.split('\n\n')}
                for one in texts)
    for robot in BOTH:
        for title in ('haa.parameters: smart_manifold', 'kfe.parameters: isa_v5'):
            assert own[f'actuators.{robot}/{title}, preset default'] == (
                leg[f'actuators.{title}, preset default'])
        assert own[f'bodies.{robot}.parameters: hyq_real'] == leg['leg.parameters: hyq_real']
    pressure = [next(line for line in own[f'{robot}/supply of pair.yaml']
                     if line.startswith('pressure_mpa')) for robot in BOTH]
    assert '20.7' in pressure[0] and ' 14 ' in pressure[1]


def test_another_value_of_an_unknown_actuator_is_answered_with_those_there_are():
    """The section would be a new actuator, which has no model."""
    with pytest.raises(ConfigError) as refused:
        of(legs(actuators={'kfee': {'preset': 'table_4'}}))
    assert 'robots.r2.actuators.kfee lacks model, one of ' in str(refused.value)
    assert str(refused.value).endswith('if one of the others is meant: did you mean kfe?')


def test_an_emergency_stop_of_all_is_one_of_every_robot():
    run = of(pair())
    stops = scenario_of(
        'name: s\nduration_s: 1\nfaults: [{t_s: 0.5, emergency_stop: all}]', run).faults
    assert [(own.tick, own.of, own.target) for own in stops] == [
        (500, 'emergency_stop', 'r1'), (500, 'emergency_stop', 'r2')]


@pytest.mark.parametrize('tree, message', [
    (pair(), 's: robots.r3 is not a robot of pair.yaml; valid: r1, r2'),
    ('leg', 's: robots.r3 is not a robot of leg.yaml; it has no robots')])
def test_a_scenario_of_robots_that_the_run_does_not_have_is_refused(tree, message):
    run = of(tree) if isinstance(tree, dict) else isa_ros.load(tree).configuration
    with pytest.raises(ConfigError) as refused:
        read_scenario({'name': 's', 'robots': {'r3': {'file': 'drop'}}}, Place('s'), run)
    assert str(refused.value) == message
