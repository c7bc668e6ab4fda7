"""MuJoCo as the body: tendons and joints, against its own forces, and what is refused."""

from pathlib import Path
import re

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.errors import ConfigError, SimulationDiverged
from isa_ros.replay.replay import replay
import numpy as np
import pytest

mujoco = pytest.importorskip('mujoco', reason='no wheel for this Python')
from isa_ros.mujoco import MujocoBody  # noqa: E402, I100

PAGE = (Path(__file__).parents[1] / 'docs' / 'bodies.md').read_text(encoding='utf-8')
MODEL = re.search(r'```xml\n(.*?)```', PAGE, re.DOTALL)[1]
POSE = 0.5, -1.0


def model_of(text: str = MODEL) -> tuple:
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos[:len(POSE)] = POSE[:model.nq]
    mujoco.mj_forward(model, data)
    return model, data


def mounting(names=('boom', 'jib'), step: float = 1e-3) -> isa_ros.Mounting:
    return isa_ros.Mounting(
        list(names), np.arange(len(names)), np.full(len(names), 0.05), [False] * len(names), step,
        0)


def test_the_crane_of_the_page_runs_and_replays(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its files, as typed from the page; the replay has no MuJoCo."""
    for kind, name in (('yaml', 'crane.yaml'), ('xml', 'crane.xml'), ('python', 'crane.py')):
        texts = re.findall(rf'```{kind}\n(.*?)```', PAGE, re.DOTALL)
        text = next(text for text in texts if 'boom' in text or 'MujocoBody' in text)
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    result = isa_ros.load('crane.yaml').simulate(0.02)      # made by its class
    assert result['body.boom_position'][0] == pytest.approx(0.05, rel=1e-12, abs=0.0)
    bag = Bag(result.save('bag'))
    assert set(bag.provenance.bodies) == {'body.simulator', 'body.model_sha256'}
    monkeypatch.setitem(__import__('sys').modules, 'mujoco', None)
    assert replay(bag).is_equal


def test_the_motion_of_tendons_is_that_of_the_joints() -> None:
    """Accelerations are J q'' + J' q': differences of the length along MuJoCo's motion."""
    model, data = model_of()
    data.qvel[:] = 0.7, -1.1
    body = MujocoBody(model, data, mounting())
    forces = np.array([2000.0, -500.0])
    now = body.motion(body.state, forces)
    h = 1e-4
    fine = mujoco.MjModel.from_xml_string(MODEL)
    fine.opt.timestep = h
    own = mujoco.MjData(fine)
    own.qpos[:], own.qvel[:], own.ctrl[:] = POSE, data.qvel, forces
    mujoco.mj_forward(fine, own)
    lengths = [own.ten_length.copy()]
    for _ in range(2):
        mujoco.mj_step(fine, own)
        mujoco.mj_forward(fine, own)
        lengths.append(own.ten_length.copy())
    assert now.position == pytest.approx([0.05, 0.05], rel=1e-12, abs=0.0)
    assert now.velocity == pytest.approx(
        (-3 * lengths[0] + 4 * lengths[1] - lengths[2]) / (2 * h), rel=1e-4)
    assert now.acceleration == pytest.approx(
        (lengths[0] - 2 * lengths[1] + lengths[2]) / h ** 2, rel=2e-2)


def test_forces_at_rest_are_mujocos(tmp_path: Path) -> None:
    """J^T f = its bias forces."""
    model, data = model_of()
    own = isa_ros.MechanismBody(MujocoBody(model, data, mounting()), mounting())
    jacobian = np.zeros((2, 2))
    mujoco.mju_sparse2dense(jacobian, data.ten_J, model.ten_J_rownnz, model.ten_J_rowadr,
                            model.ten_J_colind)
    assert [own.sample['boom_force'][0], own.sample['jib_force'][0]] == pytest.approx(
        np.linalg.solve(jacobian.T, data.qfrc_bias), rel=1e-6)


@pytest.mark.parametrize('steps', [1, 2])
def test_its_steps_are_mj_steps_under_the_mean_of_each_fifth(steps: int) -> None:
    model, _ = model_of(MODEL.replace('timestep="0.0002"', f'timestep="{2e-4 / steps}"'))
    data = mujoco.MjData(model)
    data.qpos[:] = POSE
    body = MujocoBody(model, data, mounting())
    forces = np.linspace(1e3, 2e3, 10).reshape(5, 2)
    own = mujoco.MjData(model)
    own.qpos[:] = POSE
    for row in forces:
        own.ctrl[:] = row
        mujoco.mj_step(model, own, steps)
    state = body.stepped(body.state, forces, 1e-3)
    after = np.empty(len(state))
    mujoco.mj_getState(model, own, after, int(mujoco.mjtState.mjSTATE_INTEGRATION))
    place = 1 + model.nq + model.nv
    assert state[:place].tolist() == after[:place].tolist()
    assert body.motion(state, forces[-1]).velocity == pytest.approx(
        body.motion(after, forces[-1]).velocity, rel=1e-12, abs=0.0)


def test_stiffness_and_damping_of_a_joint() -> None:
    """A mass of 3 kg on a slide of 500 N/m and 7 N s/m: k/m and c/m."""
    text = """<mujoco><option timestep="0.0002" gravity="0 0 0"/><worldbody><body>
        <joint name="rail" type="slide" axis="1 0 0" stiffness="500" damping="7"/>
        <geom size="0.1" mass="3"/></body></worldbody>
        <actuator><motor name="boom" joint="rail"/></actuator></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos[0] = 0.3
    at = mounting(['boom'])
    body = isa_ros.MechanismBody(MujocoBody(model, data, at), at, has_response=True)
    from isa_ros.core.signals import LOAD_PORT
    ports = np.zeros(1, LOAD_PORT)
    body.ports(ports)
    assert ports['x0'] == pytest.approx([0.05]) and ports['inverse_mass'] == pytest.approx([1 / 3])
    assert ports['stiffness'] == pytest.approx([500 / 3], rel=1e-5)
    assert ports['damping'] == pytest.approx([7 / 3], rel=1e-5)
    assert body.sample['boom_force'] == pytest.approx([150.0])


@pytest.mark.parametrize(('change', 'message'), [
    (('motor name="jib"', 'motor name="arm"'), "no motor 'jib'; .*boom, arm"),
    (('motor name="jib"', 'motor name="jib" gear="2"'), 'motor jib: gear = 2, must be 1'),
    (('<motor name="jib" tendon="jib"/>', '<position name="jib" tendon="jib" kp="9"/>'),
     'motor jib: must be a <motor> without limits'),
    (('motor name="jib"', 'motor name="jib" ctrlrange="-1 1"'), 'motor jib: must be a <motor>'),
    (('<motor name="jib" tendon="jib"/>', '<motor name="jib" site="jib_rod"/>'),
     'motor jib: mjTRN_SITE, must act on a spatial tendon or a slide joint, as its act'),
    (('timestep="0.0002"', 'timestep="0.0003"'), 'timestep = 0.0003 s of the MuJoCo model, must'),
    (('timestep="0.0002"', 'timestep="0.00025"'), 'must divide a fifth of the tick of 0.001 s')])
def test_models_that_do_not_fit_are_refused(change: tuple[str, str], message: str) -> None:
    assert change[0] in MODEL
    model, data = model_of(MODEL.replace(*change))
    with pytest.raises(ConfigError, match=message):
        MujocoBody(model, data, mounting())


def test_a_timestep_as_long_as_the_tick_takes_the_mean() -> None:
    model, data = model_of(MODEL.replace('timestep="0.0002"', 'timestep="0.001"'))
    body = MujocoBody(model, data, mounting())
    forces = np.linspace(1e3, 2e3, 10).reshape(5, 2)
    once = body.stepped(body.state, forces, 1e-3)
    assert once.tolist() == body.stepped(
        body.state, np.tile(forces.mean(axis=0), (5, 1)), 1e-3).tolist()


def test_a_warning_of_mujoco_ends_the_run(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It swallows a force of 1e13 N, goes on with 0 and writes a line into a file."""
    monkeypatch.chdir(tmp_path)     # of the file
    model, data = model_of()
    body = MujocoBody(model, data, mounting())
    with pytest.raises(SimulationDiverged, match='MuJoCo: mjWARN_BAD'):
        body.stepped(body.state, np.full((5, 2), 1e13), 1e-3)
    with pytest.raises(SimulationDiverged, match='MuJoCo: mjWARN_BAD'):     # one warning is enough
        MujocoBody(*model_of(), mounting()).motion(body.state, np.array([1e13, 0.0]))


def test_the_hinge_of_the_page_turns_to_where_its_rotor_is_told(
        capsys: pytest.CaptureFixture[str]) -> None:
    """The rod hangs at 52.9 degrees of the rotor; 59 Nm sin(2.9 deg) on 300 Nm/rad is 0.6 deg."""
    program = next(text for text in re.findall(r'```python\n(.*?)```', PAGE, re.DOTALL)
                   if 'qfrc_bias' in text)
    exec(program, {})
    place = float(capsys.readouterr().out.split(']')[0].strip('['))
    assert place == pytest.approx(50.0, abs=1.0)
