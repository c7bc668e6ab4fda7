"""Controllers that a run makes and calls: their sections in run files and scenarios."""

from dataclasses import replace

import isa_ros
from isa_ros.config.runs.run_config import RUN
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.text.yaml_text import parse
from isa_ros.controller import Controller, Setpoint
from isa_ros.errors import ConfigError, RunError
import numpy as np
import pytest
from tests.config.runs.pullers import Failing, Puller

PULLER = 'tests.config.runs.pullers:Puller'
COUNTING = 'tests.config.runs.pullers:Counting'
HFE = {'force': 200.0, 'actuator': 'hfe'}


def leg(**controllers):
    return isa_ros.load('leg', changes={'controllers': controllers})


def test_a_section_with_a_class_is_called_and_an_empty_one_is_a_node():
    run = leg(pull={'class': PULLER, **HFE}, sway={}).configuration
    assert run.controllers == ('sway',)
    own, = run.called
    assert (own.name, own.maker, dict(own.values)) == ('pull', PULLER, HFE)


def test_the_resolved_text_has_all_of_it():
    run = leg(pull={'class': PULLER, **HFE}, sway={}).configuration
    assert run_of_text(run.to_yaml()) == run
    assert parse(run.to_yaml(), '')['controllers'] == {
        'sway': {}, 'pull': {'class': PULLER, **HFE}}
    assert isa_ros.load('leg').configuration.digest != run.digest


def test_the_class_gives_what_the_object_gives():
    """The same requests at the same ticks, with the arguments that the section has."""
    made = leg(pull={'class': PULLER, **HFE}).simulate(0.02)
    given = isa_ros.load('leg').simulate(0.02, controllers=[Puller(200.0, 'hfe')])
    assert np.array_equal(made['hfe.force'], given['hfe.force'])
    assert made['hfe.force_reference'][-1] == pytest.approx(200.0, rel=0.2)
    idle = isa_ros.load('leg').simulate(0.02)
    assert not np.array_equal(made['hfe.force'], idle['hfe.force'])


def test_a_given_object_stands_in_for_the_class_of_its_name():
    run = leg(pull={'class': PULLER, **HFE})
    found = run.simulate(0.02, controllers={'pull': Puller(200.0, 'kfe')})
    alone = isa_ros.load('leg').simulate(0.02, controllers=[Puller(200.0, 'kfe')])
    assert np.array_equal(found['hfe.force'], alone['hfe.force'])
    assert np.array_equal(found['kfe.force'], alone['kfe.force'])


def test_a_scenario_changes_values_and_adds_controllers():
    """What it leaves out is as in the run file."""
    run = isa_ros.load(
        'leg', {'name': 'pulled', 'duration_s': 0.02, 'controllers': {
            'pull': {'force': 300.0}, 'other': {'class': PULLER, 'force': 1.0,
                                                'actuator': 'kfe'}}},
        changes={'controllers': {'pull': {'class': PULLER, **HFE}}}).configuration
    assert {own.name: dict(own.values) for own in run.called} == {
        'pull': {'force': 300.0, 'actuator': 'hfe'},
        'other': {'force': 1.0, 'actuator': 'kfe'}}


def test_a_saved_simulation_continues_with_its_controllers():
    run = leg(pull={'class': PULLER, **HFE})
    first, second = run.simulation(), run.simulation()
    for _ in range(6):
        first.step()
    second.restore(first.snapshot())
    for _ in range(4):
        first.step()
        second.step()
    assert first.snapshot() == second.snapshot()
    assert first.samples['hfe'].tobytes() == second.samples['hfe'].tobytes()


def test_each_continues_from_its_own_state_and_a_reset_begins_anew():
    """Two that count: the state of the first is not that of the second."""
    run = leg(few={'class': COUNTING, 'actuator': 'hfe'},
              many={'class': COUNTING, 'actuator': 'kfe', 'first': 500.0})
    first, second = run.simulation(), run.simulation()
    for _ in range(5):
        first.step()
    state = first.snapshot()
    second.restore(state)
    for own in (first, second):
        for _ in range(3):
            own.step()
    assert [float(row['effort']) for row in second.applied[1:]] == [7.0, 507.0]
    assert first.snapshot() == second.snapshot()
    second.reset()
    for _ in range(2):
        second.step()
    assert [float(row['effort']) for row in second.applied[1:]] == [1.0, 501.0]
    saved = first.loop.save()
    with pytest.raises(ConfigError, match='has 4 participants, the run has 5'):
        second.loop.restore(replace(saved, participants=saved.participants[:4]))


def test_every_value_of_a_section_is_told_under_its_key():
    """Those in lists and sections too, as `isa params` shows them."""
    tables = isa_ros.load('leg', changes={'controllers': {'trot': {
        'class': PULLER, 'feet': [{'gain': 1.5}, {'gain': 2.5}], 'speeds': [0.25, 0.75]},
        'sway': {}}}).configuration
    leaves = {leaf.key: leaf.value for leaf in RUN.leaves(tables, '')
              if leaf.key.startswith('controllers')}
    assert leaves.pop('controllers').nodes == ('sway',)
    assert leaves == {
        'controllers.trot.class': PULLER, 'controllers.trot.feet[0].gain': 1.5,
        'controllers.trot.feet[1].gain': 2.5, 'controllers.trot.speeds[0]': 0.25,
        'controllers.trot.speeds[1]': 0.75}
    plain = isa_ros.load('leg').configuration
    assert [leaf.key for leaf in RUN.leaves(plain, '') if leaf.key.startswith('contr')] == [
        'controller_offset_ns', 'controllers']


def test_a_node_has_no_name_of_a_class():
    with pytest.raises(ConfigError, match="controllers: the name 'pull' is taken"):
        leg(pull={'class': PULLER, **HFE}).configuration.with_controllers(['pull'])


@pytest.mark.parametrize('controllers, message', [
    ({'pull': {'force': 1.0}}, 'leg.yaml: controllers.pull lacks class, module:Class'),
    ({'pull': {'class': 'pullers'}},
     "leg.yaml: controllers.pull.class = 'pullers', must be module:Class, as my_trot:MyTrot"),
    ({'pull': {'class': 3}}, 'leg.yaml: controllers.pull.class = 3, must be of type str'),
    ({'pull': 3}, 'leg.yaml: controllers.pull = 3, must be a section'),
    ({'hfe': {'class': PULLER}}, "leg.yaml: controllers: the name 'hfe' is taken"),
    ({'hfe': {}}, "leg.yaml: controllers: the name 'hfe' is taken"),
    ({'Pull': {'class': PULLER}}, 'leg.yaml: controllers.Pull: the name'),
    (3, 'leg.yaml: controllers = 3, must be a section')])
def test_refused_as_the_file_is_read(controllers, message):
    with pytest.raises(ConfigError) as refused:
        isa_ros.load('leg', changes={'controllers': controllers})
    assert message in str(refused.value)


@pytest.mark.parametrize('section, message', [
    ({'class': 'no_such_module:Pull'}, 'no_such_module'),
    ({'class': 'tests.config.runs.pullers:Missing'},
     'leg.yaml: controllers.pull.class = tests.config.runs.pullers:Missing: '
     'tests.config.runs.pullers has no class Missing'),
    ({'class': 'tests.config.runs.pullers:NO_CLASS'},
     'NO_CLASS is of type int, must be a class'),
    ({'class': PULLER, 'force': 2.0, 'actuator': 'hfe', 'farce': 2.0},
     "leg.yaml: controllers.pull: Puller got an unexpected keyword argument 'farce'; it takes "
     'force, actuator'),
    ({'class': 'tests.config.runs.pullers:Loose'},
     "controllers.pull: Loose missing a required argument: 'actuator'; it takes actuator, gain"),
    ({'class': 'tests.config.runs.pullers:pull'}, 'must be a class derived from'),
    ({'class': 'tests.config.runs.pullers:Absent'},
     'leg.yaml: controllers.pull: SystemExit: 0 (pullers.py:'),
    ({'class': 'collections:OrderedDict'}, 'must be a class derived from isa_ros.Controller'),
    ({'class': PULLER, 'force': -1.0, 'actuator': 'hfe'},
     'leg.yaml: controllers.pull: force = -1 N, must be >= 0 N')])
def test_refused_before_the_run_begins(section, message):
    with pytest.raises(ConfigError) as refused:
        leg(pull=section).simulation()
    assert 'controllers.pull' in str(refused.value)
    assert message in str(refused.value)
    assert str(refused.value).count('controllers.pull') == 1


@pytest.mark.parametrize('found, message', [
    (ValueError('no\nway'), 'ValueError: no way (pullers.py:'),
    (SystemExit(0), 'SystemExit: 0 (pullers.py:'),
    ({'rom': Setpoint(0.0)}, "'rom' is not an actuator of the run; valid: ram"),
    (3, '3 are no setpoints by actuator'),
    ({'ram': Setpoint(float('nan'))}, 'ram: setpoint position = nan, must be finite')])
def test_a_controller_that_fails_ends_the_run_with_its_name_and_time(found, message):
    """The exit code is that of a body that raises."""
    with pytest.raises(RunError) as ended:
        isa_ros.load('rig_linear').simulate(0.01, controllers=[Failing(found)])
    assert str(ended.value).startswith(f'Failing.step at t = 0.002 s: {message}')
    assert ended.value.exit_code == 3


def test_one_of_a_run_file_has_its_key_too():
    run = isa_ros.load('rig_linear', changes={'controllers': {
        'c': {'class': 'tests.config.runs.pullers:Leaving', 'code': 7}}})
    with pytest.raises(RunError, match=r'^controllers\.c: Leaving\.step at t = 0\.002 s: SystemE'):
        run.simulate(0.01)


def test_two_classes_may_request_the_same_actuator_the_last_wins():
    run = leg(one={'class': PULLER, **HFE}, two={'class': PULLER, 'force': 0.0,
                                                 'actuator': 'hfe'})
    alone = leg(two={'class': PULLER, 'force': 0.0, 'actuator': 'hfe'})
    assert np.array_equal(run.simulate(0.01)['hfe.force'], alone.simulate(0.01)['hfe.force'])


def test_the_class_is_a_controller():
    assert issubclass(Puller, Controller)
