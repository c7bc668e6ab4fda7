"""Pushes on a robot during a run: from a scenario, by hand, recorded, replayed and refused."""

import json
from pathlib import Path

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.errors import ConfigError
from isa_ros.replay.replay import replay
from isa_ros.scenario.robots import _target_there
import numpy as np
import pytest

JOLT = {'t_s': 0.01, 'body': 'body', 'set': {'push_y': 2000.0}, 'until_s': 0.03}


def test_a_jolt_of_a_scenario_is_recorded_and_replayed(tmp_path: Path) -> None:
    """40 Ns on the trunk: it moves from its beginning on, to the left; its work is counted."""
    run = isa_ros.load('quadruped.yaml')
    plain, pushed = run.simulate(0.04), run.simulate(0.04, faults=[JOLT])
    apart = pushed['body.velocity'][:, 1] - plain['body.velocity'][:, 1]
    assert np.all(apart[:11] == 0.0) and np.all(apart[12:] > 0.0)
    assert apart[-1] > 0.2
    assert pushed['body.push_work'][10] == 0.0 < pushed['body.push_work'][30]
    assert pushed['body.push_work'][40] == pushed['body.push_work'][30]
    assert replay(Bag(pushed.save(tmp_path / 'bag'))).is_equal


def test_a_push_by_hand_is_that_of_the_scenario(tmp_path: Path) -> None:
    """A saved state has the push that is in force; after a reset there is none."""
    def tail(simulation: isa_ros.Simulation, n: int) -> bytes:
        for _ in range(n):
            simulation.step()
        return bytes(simulation.surroundings.snapshot())
    scenario = tmp_path / 'jolt.yaml'
    scenario.write_text(json.dumps({'name': 'jolt', 'duration_s': 0.04, 'changes': [JOLT]}))
    run = isa_ros.load('quadruped.yaml')
    planned = isa_ros.load('quadruped.yaml', scenario).simulation()
    own = run.simulation()
    tail(own, 10)
    own.tune('body', {'push_y': 2000.0})
    assert own.surroundings.bodies['body'].snapshot() == (
        tail(planned, 10) and planned.surroundings.bodies['body'].snapshot())
    tail(own, 10), tail(planned, 10)
    again = run.simulation()
    again.restore(own.snapshot())
    bodies = [one.surroundings.bodies['body'] for one in (planned, own, again)]
    for one in (planned, own, again):
        tail(one, 5)
    assert bodies[0].snapshot() == bodies[1].snapshot() == bodies[2].snapshot()


@pytest.mark.parametrize(('changes', 'message'), [
    ({'body': 'robot'}, r"faults\[0\].set: 'robot' is not a body that may be pushed"),
    ({'set': {'push_up': 1.0}}, 'push_up of body is unknown or does not change'),
    ({'set': {'push_y': 1e9}}, r'push_y = 1e\+09 N, must be <= 100000'),
])
def test_a_push_that_cannot_be_is_refused(changes: dict, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        isa_ros.load('quadruped.yaml').simulate(0.04, faults=[JOLT | changes])


def test_a_fixed_root_is_not_pushed() -> None:
    with pytest.raises(ConfigError, match='body. is not a body that may be pushed'):
        isa_ros.load('crane.yaml').simulate(0.04, faults=[JOLT])


def test_a_push_in_the_scenario_of_a_robot_is_on_that_robot() -> None:
    """In a scenario of several robots `body` is the body of the one whose file it is."""
    fault = _target_there(dict(JOLT), 'r1')
    assert fault == JOLT | {'body': 'r1'}
    assert _target_there(JOLT | {'body': 'arm'}, 'r1')['body'] == 'r1/arm'
