"""The actuators in a loop of the caller: forces, starts, result, replay, refusals."""

from pathlib import Path

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.errors import ConfigError, SimulationDiverged
from isa_ros.replay.replay import replay
import numpy as np
import pytest
from tests.surroundings.mass_on_spring import LEVERS, MASS, MassOnSpring, OFFSETS

TICKS = 40
RIG = {
    'name': 'loop', 'step_ms': 0.2, 'controller_offset_ms': 0.0,
    'supply': {'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0},
    'body': {'kind': 'external', 'actuators': ['back', 'out']},
    'actuators': {'out': {'model': 'isa_v5', 'initial_position_mm': 60.0},
                  'back': {'model': 'isa_v5', 'initial_position_mm': 40.0}}}
SCENARIO = {
    'name': 'push', 'duration_s': 0.2, 'tracks': {
        'out': [{'t_s': 0.0, 'position': 0.06, 'effort': 900.0, 'stiffness': 1e5,
                 'damping': 1e3}]}}


def run_with(**changes: object) -> isa_ros.Run:
    return isa_ros.load({**RIG, **changes}, SCENARIO)


def rest_of(mechanism: MassOnSpring) -> np.ndarray:
    """Return the smallest forces that hold it."""
    return LEVERS * 390.0 / (LEVERS @ LEVERS)


def driven(actuators: isa_ros.Actuators, ticks: int) -> MassOnSpring:
    """Move the mass on its spring by the actuators, window by window."""
    mechanism = MassOnSpring()
    actuators.start(OFFSETS, rest_of(mechanism))
    for _ in range(ticks):
        now = mechanism.motion(mechanism.state, actuators.forces)
        for forces in actuators.advance(
                now.position, now.velocity, now.acceleration,
                inverse_mass=LEVERS * LEVERS / MASS):
            mechanism.state = mechanism.stepped(mechanism.state, forces[np.newaxis], 4e-5)
    return mechanism


def test_the_loop_of_the_caller_gives_what_our_loop_gives(tmp_path: Path) -> None:
    """
    The same mass moved by both over 8 ms, the forces of both at 0.2 ms.

    The ports differ by the look-ahead: place within 1 % of the 36 um that it moves, force within
    2 % of its range.
    """
    actuators = isa_ros.Actuators(run_with())
    mechanism = driven(actuators, TICKS)
    yours, ours = actuators.result, run_with().simulate(TICKS * 2e-4, body=MassOnSpring)
    assert len(yours.time) == len(ours.time) == TICKS + 1
    assert yours.time[-1] == pytest.approx(8e-3, rel=1e-12, abs=0.0)
    place = ours['body.out_position'] - ours['body.out_position'][0]
    assert np.ptp(place) > 3e-5
    assert yours['body.port_x0'][2:, 1] - OFFSETS[1] == pytest.approx(
        place[1:-1], abs=0.01 * np.ptp(place))
    for name in ('out', 'back'):
        assert yours[f'{name}.force'] == pytest.approx(
            ours[f'{name}.force'], abs=0.02 * np.ptp(ours['out.force']) + 10.0)
    assert mechanism.state[0] != 0.0
    assert replay(Bag(yours.save(tmp_path / 'bag'))).is_equal


def test_it_begins_where_it_is_told_and_begins_anew() -> None:
    actuators = isa_ros.Actuators(run_with())
    actuators.start()
    assert actuators.names == ('back', 'out')
    assert actuators.result['body.port_x0'][0].tolist() == [0.04, 0.06]
    assert actuators.forces.tolist() == [0.0, 0.0]
    means = actuators.advance([0.04, 0.06], [0.0, 0.0], [0.0, 0.0])
    assert means.shape == (5, 2) and means[:, 1].tolist() != means[:, 0].tolist()
    assert actuators.forces == pytest.approx(means[-1], abs=0.5 * abs(means[-1]).max() + 1.0)
    actuators.start([0.05, 0.02], [100.0, -700.0])
    assert len(actuators.result.time) == 1
    assert actuators.forces.tolist() == [100.0, -700.0]
    simulation = actuators.simulation
    assert simulation.samples['out'].position == pytest.approx(0.02, abs=1e-4)
    assert simulation.samples['back'].position == pytest.approx(0.05, abs=1e-4)
    assert simulation.samples['out'].force == pytest.approx(-700.0, abs=10.0)


def test_a_port_has_all_that_is_given() -> None:
    """Without ``a_bias`` it is the acceleration without the force at the end of the last tick."""
    actuators = isa_ros.Actuators(run_with())
    actuators.start(force=[300.0, -500.0])
    actuators.advance([0.041, 0.059], [0.01, 0.02], [3.0, 4.0], inverse_mass=[0.02, 0.03],
                      jerk=[5.0, 6.0], stiffness=[7.0, 8.0], damping=[0.9, 1.1])
    assert actuators.forces.tolist() == actuators.result['body.port_force'][1].tolist() != [
        300.0, -500.0]
    port = {name: actuators.result[f'body.port_{name}'][1].tolist() for name in (
        'x0', 'v0', 'a0', 'inverse_mass', 'a_bias', 'jerk', 'stiffness', 'damping')}
    assert port == {
        'x0': [0.041, 0.059], 'v0': [0.01, 0.02], 'a0': [3.0, 4.0],
        'inverse_mass': [0.02, 0.03], 'a_bias': [3.0 - 0.02 * 300.0, 4.0 + 0.03 * 500.0],
        'jerk': [5.0, 6.0], 'stiffness': [7.0, 8.0], 'damping': [0.9, 1.1]}
    actuators.advance([0.04, 0.06], [0.0, 0.0], [1.0, 2.0], a_bias=[-1.0, -2.0])
    result = actuators.result
    assert result['body.port_a_bias'][2].tolist() == [-1.0, -2.0]
    for name in ('jerk', 'damping'):
        assert result[f'body.port_{name}'][2].tolist() == [0.0, 0.0]
    actuators.start()   # another run, whose first port has place and force alone
    assert not any(actuators.result[f'body.port_{name}'][0].any() for name in port if name != 'x0')


def test_commands_controllers_and_a_log_that_grows() -> None:
    class Push(isa_ros.Controller):
        """Asks the second actuator for a force."""

        def step(self, state: isa_ros.State) -> dict[str, isa_ros.Setpoint]:
            """Ask."""
            return {'back': isa_ros.Setpoint(0.04, effort=-400.0)}
    actuators = isa_ros.Actuators(run_with(), [Push()])
    actuators.start()
    actuators.command('out', position=0.055)
    for _ in range(1100):
        actuators.advance([0.04, 0.06], [0.0, 0.0], [0.0, 0.0])
    result = actuators.result
    assert len(result.time) == 1101 and result['out.position'].shape == (1101,)
    assert result['back.force'][-1] < -200.0
    assert result['body.port_x0'][1100].tolist() == [0.04, 0.06]


@pytest.mark.parametrize(('call', 'message'), [
    (lambda own: own.advance([0.0], [0.0, 0.0], [0.0, 0.0]),
     r'position has the shape \(1,\), must have \(2,\): one number for each of back, out'),
    (lambda own: own.advance([0.0, 0.0], [[0.0], [0.0]], [0.0, 0.0]),
     r'velocity has the shape \(2, 1\), must have \(2,\)'),
    (lambda own: own.advance([0.0, 0.0], [0.0, np.nan], [0.0, 0.0]),
     'out: velocity = nan, must be finite'),
    (lambda own: own.advance([0.0, 0.0], [0.0, 0.0], [0.0, 0.0], jerk=[np.inf, 0.0]),
     'back: jerk = inf, must be finite'),
    (lambda own: own.advance([0.0, 0.0], [0.0, 0.0], [0.0, 0.0], inverse_mass=[0.0, -1.0]),
     'out: inverse_mass = -1, must be >= 0'),
    (lambda own: own.advance([0.05, 0.1501], [0.0, 0.0], [0.0, 0.0]),
     'out: position = 0.1501 m, must be -0.05 to 0.15 m, half a stroke beyond the ends'),
    (lambda own: own.advance([-0.0501, 0.05], [0.0, 0.0], [0.0, 0.0]),
     'back: position = -0.0501 m, must be -0.05 to 0.15 m'),
    (lambda own: own.start([0.04, 0.05], [1e6, 0.0]),
     '^back starts with a force of 1e[+]06 N, must be -5499 to 7987 N, at which its relief'),
    (lambda own: own.start([0.04, 0.05], [0.0, -1e6]), '^out starts with a force of -1e[+]06 N'),
    (lambda own: own.start([0.04, 0.5]),
     '^out starts at 0.5 m, must be within its stroke, 0 to 0.1 m')])
def test_what_cannot_be_is_refused(call, message: str) -> None:
    actuators = isa_ros.Actuators(run_with())
    with pytest.raises(ConfigError, match='call start before'):
        actuators.advance([0.0, 0.0], [0.0, 0.0], [0.0, 0.0])
    actuators.start()
    with pytest.raises(ConfigError, match=message):
        call(actuators)
    if 'starts' not in message:
        assert actuators.simulation.ticks == 0


def test_the_load_of_a_motor_may_be_anywhere() -> None:
    """As in a library of C; that of a cylinder beside it may not."""
    drum = isa_ros.load('winch').configuration.actuators[0]
    own = isa_ros.Actuators(isa_ros.load({
        **RIG, 'body': {'kind': 'external', 'actuators': ['drum', 'out']},
        'actuators': {'out': RIG['actuators']['out'], 'drum': {     # type: ignore[index]
            'model': drum.model, 'initial_position_deg': 90.0, 'parameters': {'plant': {
                'drive': {'displacement_cc_per_rad': 15.9, 'pressure_mpa': [20.0, 20.0],
                          'speed_rpm': [100.0, 1500.0], 'volumetric_percent': [90.0, 99.2],
                          'mechanical_percent': [92.0, 88.0], 'rated_pressure_mpa': 20.7},
                'valve': {'flow': {'rated_flow_lpm': 40.0, 'rated_current_ma': 10.0}}}}}}}))
    own._port['x0'] = 1e9, 0.15
    own._refuse_far()
    own._port['x0'] = 1e9, 0.16
    with pytest.raises(ConfigError, match='^out: position = 0.16 m, must be -0.05 to 0.15 m'):
        own._refuse_far()


def test_a_run_without_one_external_body_is_refused() -> None:
    with pytest.raises(ConfigError, match='Actuators needs one body of the kind external'):
        isa_ros.Actuators(isa_ros.load('leg'))


def test_a_load_that_runs_away_ends_the_run() -> None:
    actuators = isa_ros.Actuators(run_with())
    actuators.start()
    with pytest.raises(SimulationDiverged):
        for _ in range(3):
            actuators.advance([0.06, 0.06], [1e300, 0.0], [0.0, 0.0])
