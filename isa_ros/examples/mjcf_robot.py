"""
Two hydraulic actuators on hinges of any MJCF robot; its own servos hold all other joints.

    python -m isa_ros.examples.mjcf_robot universal_robots_ur5e/ur5e.xml \
        shoulder_lift_joint elbow_joint

It needs MuJoCo (``pip install -e '.[mujoco]'``) and the model, of MuJoCo Menagerie for one.
"""

from collections.abc import Mapping
import sys
from typing import Any

import isa_ros
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError, IsaError
from isa_ros.mujoco import MujocoBody
import mujoco
import numpy as np

TIMESTEP = 2e-4     # s, a fifth of the tick
MOVE = np.radians(5.0)
ACTUATORS = 'first', 'second'
ROBOT: Tree = {
    'name': 'robot', 'supply': {'kind': 'constant', 'pressure_mpa': 20.7,
                                'return_pressure_mpa': 0.0},
    'body': {'kind': 'external', 'actuators': list(ACTUATORS)},
    'actuators': {name: {'model': 'smart_manifold'} for name in ACTUATORS}}


def with_motors(path: str, joints: Mapping[str, str]) -> Any:
    """
    Return the model of an MJCF file with a motor of each actuator on its joint, not its own.

    ``joints`` has the hinge of each actuator of the run. The model is integrated by RK4 at
    `TIMESTEP`.

    Raises
    ------
    ConfigError
        The file cannot be compiled, or has no such joint.

    """
    try:
        spec = mujoco.MjSpec.from_file(path)
        known = [joint.name for joint in spec.joints]
        for joint in joints.values():
            if joint not in known:
                raise ConfigError(f'{path}: has no joint {joint!r}; {alternatives(joint, known)}')
        for own in list(spec.actuators):
            if own.target in joints.values():
                spec.delete(own)
        for name, joint in joints.items():
            spec.add_actuator(
                name=name, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT).set_to_motor()
        for key in list(spec.keys):     # its controls are those of the actuators before
            key.ctrl = []
        spec.option.timestep = TIMESTEP
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
        return spec.compile()
    except ValueError as error:
        raise ConfigError(f'{path}: {" ".join(str(error).split())}') from error


def robot(path: str, joints: Mapping[str, str], mounting: isa_ros.Mounting) -> MujocoBody:
    """Return the robot at its first keyframe, or its zero pose; its servos hold their joints."""
    model = with_motors(path, joints)
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    for k in range(model.nu):
        if model.actuator(k).name not in joints and (
                model.actuator_trntype[k] == int(mujoco.mjtTrn.mjTRN_JOINT)):
            data.ctrl[k] = data.qpos[model.jnt_qposadr[model.actuator_trnid[k, 0]]]
    return MujocoBody(model, data, mounting)


def moved(path: str, joints: Mapping[str, str], seconds: float = 0.5) -> isa_ros.Result:
    """Return a run in which each actuator turns its joint by `MOVE`, to and fro."""
    run = isa_ros.load(ROBOT)
    first = run.simulation(body=lambda mounting: robot(path, joints, mounting)).body_sample
    assert first is not None
    tracks: Tree = {name: [{
        't_s': 0.0, 'position': float(first[f'{name}_position']), 'stiffness': 3000.0,
        'damping': 60.0, 'effort': float(first[f'{name}_force']), 'enabled': True,
        'sine': {'amplitude': float(MOVE), 'frequency_hz': 2.0}}] for name in ACTUATORS}
    return isa_ros.load(ROBOT, {
        'name': 'turn', 'duration_s': seconds, 'tracks': tracks}).simulate(
            body=lambda mounting: robot(path, joints, mounting))


def main(path: str, *joints: str) -> None:
    """Print how far each joint was turned, and by which torques."""
    if len(joints) != len(ACTUATORS):
        raise ConfigError(f'{len(joints)} joints, must be {len(ACTUATORS)}')
    result = moved(path, dict(zip(ACTUATORS, joints)))
    for name, joint in zip(ACTUATORS, joints):
        place = np.degrees(result[f'body.{name}_position'])
        torque = result[f'body.{name}_force']
        print(f'{joint}: {place.min() - place[0]:.2f} to {place.max() - place[0]:.2f} deg, '
              f'{torque.min():.1f} to {torque.max():.1f} Nm')


if __name__ == '__main__':
    try:
        main(*sys.argv[1:])
    except (IsaError, TypeError) as error:
        sys.exit(f'mjcf_robot: {error}')
