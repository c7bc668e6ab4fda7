"""The crane of Pinocchio is that of docs/bodies.md in MuJoCo."""

from pathlib import Path
import sys

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.errors import ConfigError
from isa_ros.replay.replay import replay
import numpy as np
import pytest
from tests.test_mujoco import model_of, mounting

pytest.importorskip('pinocchio', reason='no wheel for this Python')
from isa_ros.examples.pinocchio_crane import (  # noqa: E402, I100
    CRANE, crane, crane_model, main, PinocchioBody)

mujoco = pytest.importorskip('mujoco', reason='no wheel for this Python')
from isa_ros.mujoco import MujocoBody  # noqa: E402, I100

FORCES = np.array([[3000.0, -800.0], [2000.0, 500.0], [4500.0, 0.0], [-900.0, 1e3], [1e3, 2e3]])


def moving(speeds: tuple[float, float]) -> tuple[PinocchioBody, np.ndarray, np.ndarray]:
    """Return it, and its state and that of MuJoCo's crane, with joint speeds, rad/s."""
    body = crane(mounting())
    state = body.state.copy()
    state[2:] = speeds
    _, data = model_of()
    data.qvel[:] = speeds
    return body, state, data


@pytest.mark.parametrize('speeds', [(0.0, 0.0), (0.7, -1.1)])
def test_its_motion_is_that_of_mujoco(speeds: tuple[float, float]) -> None:
    """Within 1e-10, but for J' q', which is a difference along 1 us there: 1e-5."""
    body, state, data = moving(speeds)
    other = MujocoBody(data.model, data, mounting())
    for forces in FORCES[:2]:
        ours, theirs = body.motion(state, forces), other.motion(other.state, forces)
        assert ours.position == pytest.approx([0.05, 0.05], rel=1e-12, abs=0.0)
        assert ours.velocity == pytest.approx(theirs.velocity, rel=1e-10, abs=1e-12)
        assert ours.acceleration == pytest.approx(theirs.acceleration, rel=1e-5)
        assert ours.generalised == pytest.approx(theirs.generalised, rel=1e-9)


def test_its_step_is_that_of_mujoco() -> None:
    """Both take a Runge-Kutta step for each fifth."""
    body, state, data = moving((0.7, -1.1))
    other = MujocoBody(data.model, data, mounting())
    later = other.motion(other.stepped(other.state, FORCES, 1e-3), FORCES[0])
    own = body.motion(body.stepped(state, FORCES, 1e-3), FORCES[0])
    assert own.position == pytest.approx(later.position, rel=1e-12, abs=0.0)
    assert own.velocity == pytest.approx(later.velocity, rel=1e-10, abs=0.0)


def test_stiffness_and_damping_are_probed() -> None:
    """Moved by dq and made faster by dv; a hinge's configuration is its angle."""
    body, state, _ = moving((0.7, -1.1))
    moved = body.displaced(state, np.array([0.1, 0.2]), np.array([0.3, 0.4]))
    assert moved == pytest.approx([0.6, -0.8, 1.0, -0.7])
    with_response = isa_ros.MechanismBody(body, mounting(), has_response=True)
    assert with_response.sample['boom_force'] == pytest.approx(
        isa_ros.MechanismBody(body, mounting()).sample['boom_force'])


def test_it_runs_by_its_class_and_replays_without_pinocchio(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its cylinders have the forces of MuJoCo's crane within 1e-4 of them."""
    _, data = model_of()
    lift = {'name': 'lift', 'duration_s': 0.02, 'tracks': {name: [
        {'t_s': 0.0, 'position': place, 'stiffness': 1e6, 'damping': 1e4}]
        for name, place in (('boom', 0.06), ('jib', 0.045))}}
    run = isa_ros.load(CRANE, lift)
    ours, theirs = run.simulate(), run.simulate(body=lambda at: MujocoBody(*model_of(), at))
    for name in ('boom', 'jib'):
        assert np.ptp(ours[f'{name}.force']) > 500.0
        assert ours[f'body.{name}_force'] == pytest.approx(theirs[f'body.{name}_force'], rel=1e-4)
    bag = Bag(ours.save(tmp_path / 'bag'))
    assert bag.provenance.bodies['body.simulator'].startswith('Pinocchio ')
    for name in ('pinocchio', 'isa_ros.examples.pinocchio_crane'):
        monkeypatch.setitem(sys.modules, name, None)
    assert replay(bag).is_equal


def test_a_cylinder_without_its_frames_is_refused() -> None:
    with pytest.raises(ConfigError, match='the Pinocchio model crane has no frame arm_base'):
        PinocchioBody(crane_model(), np.zeros(2), mounting(('boom', 'arm')))


def test_the_program_prints_both_cylinders(
        capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    own = isa_ros.Run.simulate
    monkeypatch.setattr(isa_ros.Run, 'simulate', lambda run, seconds: own(run, 0.005))
    main()
    assert [line.partition(':')[0] for line in capsys.readouterr().out.splitlines()] == [
        'boom', 'jib']
