"""Controllers of single robots in a run of several: what they are made for, see and command."""

from typing import Any

import isa_ros
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.one_robot import one_robot
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.text.yaml_text import read
from isa_ros.controller import Controller, Setpoint, Setpoints, State
from isa_ros.errors import ConfigError
import numpy as np
import pytest
from tests.config.runs.pullers import Counting

COUNTING = 'tests.config.runs.pullers:Counting'
OF_R1 = {'class': COUNTING, 'actuator': 'hfe'}
OF_R2 = {'class': COUNTING, 'actuator': 'kfe', 'first': 100.0}
PUMP = {'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0}


def pair(**others: Any) -> dict[str, Any]:
    """Return a run file of two legs, each with a controller of its own."""
    return {'name': 'pair', 'robots': {
        'r1': {'file': 'leg', 'controllers': {'count': OF_R1}},
        'r2': {'file': 'leg', 'controllers': {'count': OF_R2}}}} | others


def legs(**others: Any) -> dict[str, Any]:
    """Return a run file of two legs without controllers."""
    return {'name': 'pair', 'robots': {name: {'file': 'leg'} for name in ('r1', 'r2')}} | others


class Looking(Controller):
    """Keeps the names, the position of the knee and the first field of all rows."""

    def start(self, names):
        self.names, self.seen = names, []

    def step(self, state: State) -> Setpoints:
        assert state.body is not None
        self.seen.append((
            state.t_ns, list(state.actuators), list(state.supplies), list(state.bodies),
            float(state.actuators['kfe'].position), state.rows['position'].tolist(),
            float(state.body.height)))
        return Setpoints(['kfe', 'haa'], np.array([0.05, 1.0]))


def test_each_robot_moves_as_alone_with_its_controller():
    """Bit for bit: the controllers of two files of one name, made for their robots."""
    run = isa_ros.load(pair())
    assert [own.name for own in run.configuration.called] == ['r1/count', 'r2/count']
    assert run_of_text(run.configuration.to_yaml()) == run.configuration
    both = run.simulate(0.02)
    for robot, section in (('r1', OF_R1), ('r2', OF_R2)):
        alone = isa_ros.load('leg', changes={'controllers': {'count': section}}).simulate(0.02)
        for signal in ('haa.position', 'hfe.force', 'kfe.force_reference'):
            assert np.array_equal(both[f'{robot}/{signal}'], alone[signal]), signal
        assert np.array_equal(both[f'{robot}.height'], alone['body.height'])


def test_a_quadruped_trots_beside_one_that_squats_as_each_alone():
    """The scenario of each has the class and its program."""
    run = isa_ros.load(
        {'name': 'herd', 'robots': {name: {'file': 'quadruped'} for name in ('r1', 'r2')}},
        {'name': 'both', 'duration_s': 12.0, 'robots': {
            'r1': {'file': 'quadruped_trot'}, 'r2': {'file': 'quadruped_squat'}}})
    both = run.simulate(0.02)
    for robot, scenario in (('r1', 'quadruped_trot'), ('r2', 'quadruped_squat')):
        alone = isa_ros.load('quadruped', scenario).simulate(0.02)
        for signal in ('lf_kfe.force', 'rh_hfe.position'):
            assert np.array_equal(both[f'{robot}/{signal}'], alone[signal]), signal


def test_it_sees_its_own_robot_by_the_names_of_its_file():
    """And its requests have them; those of the run stay what others see."""
    look, whole = Looking(), Counting('r1/haa')
    simulation = isa_ros.load(legs()).simulation({'r2/look': look, 'all': whole})
    simulation.tune('r2/supply', {'pressure_mpa': 18.0})
    for _ in range(3):
        simulation.step()
    assert list(look.names) == ['haa', 'hfe', 'kfe']
    t_ns, names, supplies, bodies, knee, rows, height = look.seen[-1]
    assert (t_ns, names, supplies, bodies) == (
        2_000_000, ['haa', 'hfe', 'kfe'], ['supply'], ['body'])
    assert knee == rows[2] and len(rows) == 3
    twin = isa_ros.load(legs()).simulation({'r2/look': Looking(), 'all': Counting('r1/haa')})
    twin.tune('r2/supply', {'pressure_mpa': 18.0})
    for _ in range(2):
        twin.step()
    assert knee == twin.samples['r2/kfe'].position
    assert height == twin.body_samples['r2'].height
    kinds = simulation.applied['kinds']
    assert (kinds != 0).tolist() == [True, False, False, True, False, True]
    assert simulation.applied['position'][[5, 3]].tolist() == [0.05, 1.0]


def test_a_pump_of_the_run_has_its_own_name():
    """It feeds both; that of the other robot alone is not seen."""
    look = Looking()
    simulation = isa_ros.load(legs(supplies={
        'pump': PUMP | {'feeds': ['r1/kfe', 'r2/kfe']}})).simulation({'r1/look': look})
    simulation.step()
    assert look.seen[0][2] == ['pump', 'supply']


def test_a_supply_of_another_robot_keeps_its_name():
    """Of one that feeds both a robot is told what it feeds of its own."""
    run = isa_ros.load(legs(supplies={'r1/pump': PUMP | {'feeds': ['r1/kfe', 'r2/kfe']}}))
    first, second = (one_robot(run.configuration, robot, 'here') for robot in ('r1', 'r2'))
    assert [(own.name, own.feeds) for own in first.supplies] == [
        ('pump', ('kfe',)), ('supply', ('haa', 'hfe'))]
    assert [(own.name, own.feeds) for own in second.supplies] == [
        ('r1/pump', ('kfe',)), ('supply', ('haa', 'hfe'))]


def test_a_saved_run_continues_with_the_controllers_of_its_robots():
    first, second = isa_ros.load(pair()).simulation(), isa_ros.load(pair()).simulation()
    for _ in range(4):
        first.step()
    second.restore(first.snapshot())
    for own in (first, second):
        own.step()
    assert first.applied.tobytes() == second.applied.tobytes()
    assert [float(second.applied[row]['effort']) for row in (1, 5)] == [4.0, 104.0]


def test_one_robot_of_a_run_is_that_of_its_file():
    """Names, joints and supply; the source and the tick are those of the run."""
    run, leg = (isa_ros.load(tree).configuration for tree in (pair(), read(find('leg', CONFIG))))
    alone = one_robot(run, 'r2', 'here')
    assert alone.actuators == leg.actuators and alone.bodies == leg.bodies
    assert alone.supplies == leg.supplies and not alone.called
    assert alone.stop_groups[0].actuators == ('haa', 'hfe', 'kfe')


def test_nodes_are_those_of_the_run_beside_the_classes_of_robots():
    robots = {name: {'file': 'leg', 'controllers': {'sway': {}, 'count': OF_R1}}
              for name in ('r1', 'r2')}
    run = isa_ros.load({'name': 'pair', 'robots': robots}).configuration
    assert run.controllers == ('sway',)
    assert [own.name for own in run.called] == ['r1/count', 'r2/count']
    own = isa_ros.load(pair(controllers=['watch'])).configuration
    assert (own.controllers, len(own.called)) == (('watch',), 2)


@pytest.mark.parametrize(('tree', 'message'), [
    (pair(controllers={'r1/count': OF_R1}), 'pair.yaml: controllers.r1/count: the name is that '
     'of a part of a robot'),
    (legs(controllers={'r3/count': OF_R1}), 'pair.yaml: controllers.r3/count: no actuator is in '
     "the namespace 'r3'; "),
    (legs(controllers={'r1/kfe': OF_R1}), "the name 'r1/kfe' is taken"),
    (legs(controllers={'a/b/c': OF_R1}), "controllers.a/b/c: the name = 'a/b/c', must be"),
    (pair(controllers=3), 'pair.yaml: controllers = 3, must be a section')])
def test_a_controller_of_no_robot_is_refused(tree, message):
    with pytest.raises(ConfigError) as refused:
        isa_ros.load(tree)
    assert message in str(refused.value)


def test_what_it_asks_of_another_robot_is_refused():
    """By the name in the run: a controller names what is its own."""
    class Astray(Controller):
        def step(self, state):
            return {'r2/kfe': Setpoint(0.05)}
    with pytest.raises(isa_ros.errors.RunError, match="t = 0 s: 'r1/r2/kfe' is not an actua"):
        isa_ros.load(legs()).simulation({'r1/astray': Astray()}).step()
