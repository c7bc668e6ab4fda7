"""What the functions of a mechanism give wrong is named with its place."""

import isa_ros
from isa_ros.errors import ConfigError, RunError
from isa_ros.surroundings.mechanism_body import MechanismBody
import numpy as np
import pytest
from tests.surroundings.mass_body import mounting, moving_body, replies_of
from tests.surroundings.mass_on_spring import MassOnSpring


def changed(name: str, function: object) -> MechanismBody:
    """Return a body whose mechanism has another function."""
    mechanism = MassOnSpring()
    setattr(mechanism, name, function)
    return MechanismBody(mechanism, mounting())


def motion_of(*arrays: object) -> object:
    return lambda state, forces: isa_ros.Motion(*arrays)


@pytest.mark.parametrize(('motion', 'message'), [
    (motion_of([0.04, 0.06], [0.0], [0.0, 0.0]),
     r'^velocity of the motion of MassOnSpring at t = 0 has the shape \(1,\), must have \(2,\): '
     'one number for each of out, back'),
    (motion_of([0.04, 0.06], [0.0, 0.0], 1.0), r'acceleration of the motion .* shape \(\)'),
    (motion_of([0.04, np.nan], [0.0, 0.0], [0.0, 0.0]),
     '^back: position of the motion of MassOnSpring at t = 0 = nan, must be finite'),
    (lambda state, forces: MassOnSpring().motion(state, -forces),
     'out accelerates by -0.025 m/s2 . rad/s2 under 1 N . Nm at t = 0, must be >= 0')])
def test_a_motion_that_cannot_be_is_refused_at_the_start(motion, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        changed('motion', motion)


def test_lists_will_do() -> None:
    own = MassOnSpring()
    body = changed('motion', lambda state, forces: tuple(
        part.tolist() for part in own.motion(state, forces)))
    assert body.snapshot() == MechanismBody(MassOnSpring(), mounting()).snapshot()


def test_what_the_caller_wrote_wrong_is_named_with_its_place() -> None:
    def fails(*arguments: object) -> None:
        raise KeyError('no licence')
    with pytest.raises(RunError, match=r"^MassOnSpring.motion: KeyError: 'no licence' \(test_"):
        changed('motion', fails)
    with pytest.raises(RunError, match='^MassOnSpring.stepped: KeyError'):
        changed('stepped', fails)   # its look-ahead is tried before the run
    with pytest.raises(ConfigError, match=r'its state has the shape \(3,\), must have \(2,\)'):
        changed('stepped', lambda state, forces, seconds: np.zeros(3))
    body = changed('displaced', fails)
    body._mechanism.stepped = fails
    with pytest.raises(RunError, match='^MassOnSpring.stepped: KeyError'):
        body.advance(replies_of(np.zeros((2, 5))))


def test_a_state_cannot_be_changed_in_place() -> None:
    def in_place(state: np.ndarray, forces: np.ndarray, seconds: float) -> np.ndarray:
        state += 1.0
        return state
    with pytest.raises(RunError, match='stepped: .*read-only'):
        changed('stepped', in_place)
    body = moving_body(False)
    body.restore(body.snapshot())
    body._mechanism.stepped = in_place
    with pytest.raises(RunError, match='stepped: .*read-only'):
        body.advance(replies_of(np.zeros((2, 5))))


def test_a_response_needs_what_it_is_made_of() -> None:
    mechanism = MassOnSpring()
    own = mechanism.motion
    mechanism.motion = lambda state, forces: own(state, forces)._replace(generalised=None)
    with pytest.raises(ConfigError, match='has_response needs generalised accelerations'):
        MechanismBody(mechanism, mounting(), has_response=True)
