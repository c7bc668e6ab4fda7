"""Two legs in one run: named columns, topics, starts and states; a bag that replays."""

from pathlib import Path
from typing import Any

import isa_ros
from isa_ros.analysis.signals.signals import read_signals
from isa_ros.bag.reader import Bag
from isa_ros.config.listing import describe
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.text.yaml_text import dump
from isa_ros.errors import ConfigError
from isa_ros.replay.replay import replay
import numpy as np
import pytest
from tests.scripting.legs import two_legs

TICKS = 20


def started(**starts: dict[str, float]) -> isa_ros.Run:
    """Return the run with starts by the name of a leg."""
    return isa_ros.load(two_legs(), {
        'name': 'hang', 'bodies': starts, 'tracks': {}, 'duration_s': TICKS * 1e-3})


def test_two_legs_move_as_each_alone() -> None:
    """On one constant supply, which they do not share the flow of: bit for bit."""
    result = started(left={'foot_height_mm': 80.0}).simulate()
    for side, height in (('left', 80.0), ('right', None)):
        alone = isa_ros.load('leg').replace({} if height is None else {
            'leg.start.foot_height_mm': height}).simulate(TICKS * 1e-3)
        for field in ('position', 'torque', 'foot_position', 'height'):
            assert np.array_equal(result[f'{side}.{field}'], alone[f'body.{field}']), field
        assert np.array_equal(result[f'{side}_kfe.force'], alone['kfe.force'])
    assert result['left.height'][0] != result['right.height'][0]
    assert 'body.height' not in result and result.units['left.height'] == 'm'
    noise = [result[f'{side}.trunk_angular_velocity'] for side in ('left', 'right')]
    assert not np.array_equal(*noise)


def test_their_bag_has_topics_of_their_names_and_replays(tmp_path: Path) -> None:
    result = started(left={'foot_height_mm': 80.0}).simulate()
    bag = result.save(tmp_path / 'bag')
    signals = read_signals(bag)
    for side in ('left', 'right'):
        for field in ('position', 'foot_force', 'height'):
            name = f'{side}.{field}'
            assert np.array_equal(signals[name], result[name])
            assert signals.unit(name) == result.units[name]
        readings = signals.over_time(f'{side}.trunk_angular_velocity')
        assert np.array_equal(readings.values, result[f'{side}.trunk_angular_velocity'][::2])
    topics = set(Bag(bag).types)
    assert {'/left/joint_states', '/right/ground_contact', '/left/trunk/imu'} <= topics
    assert not {'/joint_states', '/coordinator/ground_contact', '/trunk/imu'} & topics
    assert replay(Bag(bag)).is_equal


def test_a_saved_state_holds_both() -> None:
    simulation = started().simulation()
    for _ in range(5):
        simulation.step()
    saved = simulation.snapshot()
    after = [simulation.step() and own.tobytes() for own in simulation.body_samples.values()]
    simulation.restore(saved)
    assert [simulation.step() and own.tobytes()
            for own in simulation.body_samples.values()] == after
    assert simulation.body_sample is None and list(simulation.body_samples) == ['left', 'right']


def test_a_controller_sees_them_by_name() -> None:
    class Look(isa_ros.Controller):
        """Keeps the heights that it sees."""

        seen: list[tuple[float, float]] = []

        def step(self, state: isa_ros.State) -> dict[str, isa_ros.Setpoint]:
            """Return nothing."""
            assert state.body is None
            self.seen.append((state.bodies['left'].height, state.bodies['right'].height))
            return {}
    result = started(right={'foot_height_mm': 90.0}).simulate(0.003, controllers=[Look()])
    assert Look.seen == [(left, right) for left, right in zip(
        result['left.height'][:3], result['right.height'][:3])]


def test_their_text_and_list_have_both(tmp_path: Path) -> None:
    run = started().configuration
    assert run_of_text(run.to_yaml()) == run and run.leg is None
    path = tmp_path / 'two.yaml'
    path.write_text(dump(two_legs()), encoding='utf-8')
    listed = describe(str(path), values={'bodies.left.start.kfe_deg': -100.0}).splitlines()
    heads = [line for line in listed if line.startswith('bodies.') and '  ' not in line]
    assert heads == [f'bodies.{side}.{part}' for side in ('left', 'right') for part in (
        'start', 'imus.trunk', 'parameters: hyq_real')]
    assert sum('--set' in line for line in listed) == 1


def test_a_warning_names_the_leg() -> None:
    run = isa_ros.load(two_legs()).replace({'bodies.right.ground': 'metal'})
    with pytest.warns(UserWarning, match='on the ground of the leg right, stiffness = 1e'):
        run.simulate(0.001)


@pytest.mark.parametrize(('changes', 'message'), [
    ({'bodies.right.joints.kfe': 'left_kfe'},
     "bodies.right.joints.kfe = 'left_kfe' already moves kfe of the leg left"),
    ({'bodies.right.kind': 'arm'}, "bodies.right.kind = 'arm', must be one of leg, external"),
    ({'bodies.right.start.kfe_deg': 0.0}, 'bodies.right.start.kfe_deg = 0 deg, must be within'),
    ({'actuators.left_kfe.load': {'kind': 'locked'}},
     'the actuator moves kfe of the leg left, which gives its load and start')])
def test_an_error_names_the_body(changes: dict[str, object], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        isa_ros.load(two_legs()).replace(changes)


@pytest.mark.parametrize(('starts', 'message'), [
    ({'middle': {}}, 'bodies.middle is not a body; '),
    ({'left': {'kfe_deg': 0.0}}, 'bodies.left.kfe_deg = 0 deg, must be within')])
def test_a_start_of_a_scenario_is_checked(starts: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        started(**starts)
