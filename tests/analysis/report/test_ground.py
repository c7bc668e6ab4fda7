"""Forces from the ground on bodies of any kind, found by the messages that they declare."""

from dataclasses import replace

import isa_ros
from isa_ros.analysis.report.extremes import extremes
from isa_ros.analysis.report.ground import upward_forces
from isa_ros.analysis.signals.signals import Signal, Signals, signals_of
from isa_ros.config.runs.body_config import BodyConfig
from isa_ros.surroundings.messages import columns, Force, JointStates
import numpy as np

T = np.arange(4) * 0.1
FORCE = np.arange(12.0).reshape(4, 3)


class Crawler(BodyConfig):
    """A body of a kind that the package does not have, with some forces."""

    forces: tuple[Force, ...] = ()

    def messages(self, step_ns):
        return [JointStates('/joint_states', ['hip'], ['angle'], ['speed'], []), *self.forces]


def crawler(name, *forces):
    own = Crawler(name=name, joints=())
    object.__setattr__(own, 'forces', forces)
    return own


def force(field, frame=''):
    return Force(f'/{field}', columns(field), frame=frame)


def signals(bodies, *names):
    run = replace(isa_ros.load('rig_linear').configuration, bodies=bodies)
    return Signals(run, {name: Signal(T, FORCE + k) for k, name in enumerate(names)}, T, 'here')


def test_every_body_with_a_force_in_the_axes_of_the_world_has_one():
    """One is that of the ground, several are named; in axes of its own none points up."""
    bodies = (crawler('body', force('sole_force')),
              crawler('pair', force('left'), force('right')),
              crawler('turned', force('foot', frame='foot')))
    found = dict(upward_forces(signals(
        bodies, 'body.sole_force', 'pair.left', 'pair.right', 'turned.foot')))
    assert {name: list(values) for name, values in found.items()} == {
        'ground': [2.0, 5.0, 8.0, 11.0], 'pair/left': [3.0, 6.0, 9.0, 12.0],
        'pair/right': [4.0, 7.0, 10.0, 13.0]}


def test_what_was_not_recorded_is_left_out():
    bodies = crawler('pair', force('left'), force('right')),
    assert [name for name, _ in upward_forces(signals(bodies, 'pair.right'))] == ['pair/right']


def test_the_extremes_of_a_leg_have_its_ground():
    result = isa_ros.load('leg', 'drop').simulate(duration=0.01)
    found = extremes(signals_of(result))
    upwards = result['body.foot_force'][:, 2]
    assert found[-1] == ('ground force upwards', upwards.min(), upwards.max(), 'N')
