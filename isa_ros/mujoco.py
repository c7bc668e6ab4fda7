"""
A MuJoCo model as the body of a run (extra ``mujoco``: ``pip install -e '.[mujoco]'``).

    import isa_ros
    import mujoco
    from isa_ros.mujoco import MujocoBody

    def crane(mounting):                            # called once for every simulation
        model = mujoco.MjModel.from_xml_path('crane.xml')
        data = mujoco.MjData(model)
        data.qpos[:] = 0.5, -1.0, -0.3              # the pose at t = 0
        return MujocoBody(model, data, mounting)

    isa_ros.load('crane.yaml').simulate(1.0, body=crane).save('bag')

Each actuator of the run is a motor of the model with its name and gear 1, on a spatial tendon (a
cylinder between two sites) or on a hinge or slide joint.
"""

import hashlib
from typing import Any

from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError, SimulationDiverged
from isa_ros.surroundings.mechanism import Floats, Motion, Mounting
import mujoco
import numpy as np

_NEAR_S = 1e-6      # s: J' q' by the difference of the Jacobian along the motion
_STATE = int(mujoco.mjtState.mjSTATE_INTEGRATION)   # with the warm start of the solver


class MujocoBody:
    """
    A MuJoCo model as an `isa_ros.Mechanism`, with stiffness and damping if they are asked for.

    ``data`` has the pose at t = 0; model and data are not changed. The length of a tendon, or the
    place of a joint, at t = 0 is where its actuator starts: ``initial_position_mm`` or ``_deg``.
    The model's timestep divides a fifth of the tick, or is the tick; `mj_step` integrates as the
    model says (RK4 at a fifth of the tick is what the coupling deserves, docs/bodies.md).

    Raises
    ------
    ConfigError
        The model lacks a motor, its gear is not 1, it acts on something else, or the timestep
        does not fit.

    """

    def __init__(self, model: Any, data: Any, mounting: Mounting) -> None:
        self._model, self._data, self._near = model, mujoco.MjData(model), mujoco.MjData(model)
        self._motors = np.array([_motor(model, name) for name in mounting.names])
        self._are_tendons = (model.actuator_trntype[self._motors]
                             == int(mujoco.mjtTrn.mjTRN_TENDON))
        self._at = model.actuator_trnid[self._motors, 0]
        for name, motor, is_rotary in zip(mounting.names, self._motors, mounting.are_rotary):
            _refuse_motor(model, name, int(motor), is_rotary)
        self._windows = _windows_of(model.opt.timestep, mounting.step)
        self.state = np.empty(mujoco.mj_stateSize(model, _STATE))
        mujoco.mj_getState(model, data, self.state, _STATE)
        self._known: Floats | None = None
        self._moves: tuple[Floats, Floats, Floats] = (np.zeros(0), np.zeros(0), np.zeros(0))
        self._tendons = np.zeros((model.ntendon, model.nv))
        self._closed = np.zeros(len(self._at))
        first = self.motion(self.state, np.zeros(len(self._at)))
        self._closed = first.position - mounting.positions
        self._known = None

    @property
    def provenance(self) -> dict[str, str]:
        """Return what a bag says about it: simulator, version, and a digest of the model."""
        model = self._model
        compiled = np.empty(mujoco.mj_sizeModel(model), np.uint8)
        mujoco.mj_saveModel(model, None, compiled)
        return {'simulator': f'MuJoCo {mujoco.__version__}',
                'model_sha256': hashlib.sha256(compiled.tobytes()).hexdigest()[:16]}

    def motion(self, state: Floats, forces: Floats) -> Motion:
        """Return places, speeds and accelerations; as `isa_ros.Mechanism.motion`."""
        model, data, near = self._model, self._data, self._near
        if state is self._known:    # only the forces are new
            data.ctrl[self._motors] = forces
            mujoco.mj_forwardSkip(model, data, int(mujoco.mjtStage.mjSTAGE_VEL), 1)
        else:
            mujoco.mj_setState(model, data, state, _STATE)
            data.ctrl[self._motors] = forces
            mujoco.mj_forward(model, data)
            near.qpos[:] = data.qpos
            mujoco.mj_integratePos(model, near.qpos, data.qvel, _NEAR_S)
            mujoco.mj_kinematics(model, near)
            mujoco.mj_comPos(model, near)
            mujoco.mj_tendon(model, near)
            bend = (self._turned(near, data.qvel) - self._turned(data, data.qvel)) / _NEAR_S
            self._moves = self._places(data), self._turned(data, data.qvel), bend
            self._known = state
        self._refuse_warnings(data)
        place, speed, bend = self._moves
        acceleration = data.qacc.copy()
        return Motion(place - self._closed, speed, self._turned(data, acceleration) + bend,
                      acceleration)

    def stepped(self, state: Floats, forces: Floats, seconds: float) -> Floats:
        """Return the state after a tick; as `isa_ros.Mechanism.stepped`."""
        model, data = self._model, self._near
        mujoco.mj_setState(model, data, state, _STATE)
        steps = round(seconds / model.opt.timestep)
        rows = forces if self._windows > 1 else forces.mean(axis=0)[np.newaxis]
        for row in rows:
            data.ctrl[self._motors] = row
            mujoco.mj_step(model, data, steps // len(rows))
        self._refuse_warnings(data)
        later = np.empty(len(state))
        mujoco.mj_getState(model, data, later, _STATE)
        return later

    def displaced(self, state: Floats, dq: Floats, dv: Floats) -> Floats:
        """Return the state moved; as `isa_ros.DisplaceableMechanism.displaced`."""
        model, data = self._model, self._near
        mujoco.mj_setState(model, data, state, _STATE)
        mujoco.mj_integratePos(model, data.qpos, dq, 1.0)
        data.qvel += dv
        moved = np.empty(len(state))
        mujoco.mj_getState(model, data, moved, _STATE)
        return moved

    def _places(self, data: Any) -> Floats:
        at = self._at
        return np.array([data.ten_length[own] if is_tendon
                         else data.qpos[self._model.jnt_qposadr[own]]
                         for own, is_tendon in zip(at, self._are_tendons)])

    def _turned(self, data: Any, speeds: Floats) -> Floats:
        """Return J times speeds of the model (n,), for each actuator."""
        model = self._model
        if self._are_tendons.any():
            mujoco.mju_sparse2dense(self._tendons, data.ten_J, model.ten_J_rownnz,
                                    model.ten_J_rowadr, model.ten_J_colind)
            along = self._tendons @ speeds
        return np.array([along[own] if is_tendon else speeds[model.jnt_dofadr[own]]
                         for own, is_tendon in zip(self._at, self._are_tendons)])

    def _refuse_warnings(self, data: Any) -> None:
        """Raise where MuJoCo has warned and gone on with something else."""
        for k in range(len(data.warning)):
            if data.warning[k].number:
                warning = mujoco.mjtWarning(k)
                text = mujoco.mju_warningText(k, int(data.warning[k].lastinfo))
                raise SimulationDiverged(
                    round(data.time * 1e9), f'MuJoCo: {warning.name}: {text}', float('nan'))


def _motor(model: Any, name: str) -> int:
    """Return the number of a motor."""
    found = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, name)
    if found < 0:
        known = [model.actuator(k).name for k in range(model.nu)]
        raise ConfigError(f'the MuJoCo model has no motor {name!r}; {alternatives(name, known)}')
    return int(found)


def _refuse_motor(model: Any, name: str, motor: int, is_rotary: bool) -> None:
    kind = mujoco.mjtTrn(model.actuator_trntype[motor])
    if kind == mujoco.mjtTrn.mjTRN_JOINT:
        joint = mujoco.mjtJoint(model.jnt_type[model.actuator_trnid[motor, 0]])
        is_possible = joint == (
            mujoco.mjtJoint.mjJNT_HINGE if is_rotary else mujoco.mjtJoint.mjJNT_SLIDE)
    else:
        is_possible = kind == mujoco.mjtTrn.mjTRN_TENDON and not is_rotary
    if not is_possible:
        wanted = 'hinge joint' if is_rotary else 'spatial tendon or a slide joint'
        raise ConfigError(f'motor {name}: {kind.name}, must act on a {wanted}, as its actuator is '
                          f'{"rotary" if is_rotary else "linear"}')
    gear = model.actuator_gear[motor]
    if gear[0] != 1.0 or gear[1:].any():
        raise ConfigError(f'motor {name}: gear = {gear[0]:g}, must be 1: its force is that of the '
                          'actuator')
    if (model.actuator_gaintype[motor] != int(mujoco.mjtGain.mjGAIN_FIXED)
            or model.actuator_gainprm[motor, 0] != 1.0
            or model.actuator_biastype[motor] != int(mujoco.mjtBias.mjBIAS_NONE)
            or model.actuator_dyntype[motor] != int(mujoco.mjtDyn.mjDYN_NONE)
            or model.actuator_ctrllimited[motor] or model.actuator_forcelimited[motor]):
        raise ConfigError(f'motor {name}: must be a <motor> without limits and dynamics: its '
                          'control is the force of the actuator')


def _windows_of(timestep: float, step: float) -> int:
    """Return into how many windows of constant force a tick is divided: 5, or 1."""
    steps = round(step / timestep)
    if steps >= 1 and abs(steps * timestep - step) <= 1e-9 * step and (
            steps == 1 or steps % 5 == 0):
        return 5 if steps > 1 else 1
    raise ConfigError(
        f'timestep = {timestep:g} s of the MuJoCo model, must divide a fifth of the tick of '
        f'{step:g} s, or be the tick')
