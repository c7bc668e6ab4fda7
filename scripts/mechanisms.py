"""Mechanisms that the exactness and the cost of external bodies are measured with."""

from collections.abc import Callable
from typing import Any

import isa_ros
from isa_ros.config.runs.leg_config import LegConfig
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.surroundings.bodies.leg.leg import Leg, Pose
from isa_ros.surroundings.bodies.leg.motion import (
    actuator_accelerations, continuous, ContinuousState, Coordinates, joint_speeds, leg_motion,
    LEG_STATE, leg_step)
from isa_ros.surroundings.bodies.leg.port_kernel import shear_follow
from isa_ros.surroundings.bodies.leg.sheet import leg_record
import numpy as np

N = len(ContinuousState._fields)
_SPEEDS = 4     # z, haa, hfe, kfe
STROKE_MM = 200.0
CRANE_NAMES = 'boom', 'jib', 'bucket'
POSE_DEG = 30.0, -60.0, -20.0
CRANE_XML = """
<mujoco>
  <option timestep="{timestep}" tolerance="1e-12" integrator="{integrator}"/>
  <worldbody>
    <site name="boom_base" pos="0.15 0 0.1"/>
    <geom type="plane" size="5 5 0.1" solref="0.004 1"/>
    <body pos="0 0 0.5">
      <joint axis="0 -1 0" damping="2"/>
      <geom type="capsule" fromto="0 0 0 1.2 0 0" size="0.04" mass="25"/>
      <site name="boom_rod" pos="0.35 0 0"/>
      <site name="jib_base" pos="0.75 0 0.12"/>
      <body pos="1.2 0 0">
        <joint axis="0 -1 0" damping="1"/>
        <geom type="capsule" fromto="0 0 0 0.8 0 0" size="0.03" mass="12"/>
        <site name="jib_rod" pos="0.03 0 0.16"/>
        <site name="bucket_base" pos="0.4 0 0.1"/>
        <body pos="0.8 0 0">
          <joint axis="0 -1 0" damping="0.5"/>
          <geom type="capsule" fromto="0 0 0 0.25 0 0" size="0.03" mass="4"/>
          <geom type="sphere" pos="0.25 0 -0.1" size="0.08" mass="30" solref="0.004 1"/>
          <site name="bucket_rod" pos="0.02 0 0.12"/>
        </body>
      </body>
    </body>
  </worldbody>
  <tendon>
    <spatial name="boom"><site site="boom_base"/><site site="boom_rod"/></spatial>
    <spatial name="jib"><site site="jib_base"/><site site="jib_rod"/></spatial>
    <spatial name="bucket"><site site="bucket_base"/><site site="bucket_rod"/></spatial>
  </tendon>
  <actuator>
    <motor name="boom" tendon="boom"/>
    <motor name="jib" tendon="jib"/>
    <motor name="bucket" tendon="bucket"/>
  </actuator>
</mujoco>
"""
"""A boom, a jib and a bucket with a load of 30 kg, 1.2 m above a hard floor."""


class LegMechanism:
    """
    The leg of a run file as a mechanism; its own last number is the time, s.

    Its slider is held until ``release``, as the leg's own port has it.
    """

    def __init__(self, config: LegConfig, mounting: isa_ros.Mounting) -> None:
        start = config.start
        leg = Leg(config.sheet, Pose(
            haa=start.angle('haa'), hfe=start.angle('hfe'), kfe=start.angle('kfe'),
            foot_height=start.foot_height_mm * 1e-3), mounting.step_ns)
        self._leg = leg_record(config.sheet)[0]
        self._release = start.release_s - 0.5 / NS_PER_SECOND
        at_rest = np.frombuffer(leg.snapshot(), LEG_STATE, 1, 8).view(np.recarray)[0]
        self.state = np.array([*continuous(at_rest), 0.0])

    def _of(self, state: np.ndarray) -> tuple[ContinuousState, bool]:
        *values, t = state.tolist()
        return ContinuousState(*values), t < self._release

    def motion(self, state: np.ndarray, forces: np.ndarray) -> isa_ros.Motion:
        """Return the motion of its three actuators."""
        (y, is_held), f = self._of(state), tuple(forces.tolist())
        now = leg_motion(y, f, is_held, self._leg)
        return isa_ros.Motion(
            np.array(now.position), np.array(now.lever) * joint_speeds(y),
            np.array(actuator_accelerations(y, f, is_held, self._leg)),
            np.array(now.acceleration))

    def displaced(self, state: np.ndarray, dq: np.ndarray, dv: np.ndarray) -> np.ndarray:
        """Return the state moved; the shear of the sole follows  (L14)."""
        y, _ = self._of(state)
        moved = state.copy()
        moved[:_SPEEDS] += dq
        moved[_SPEEDS:2 * _SPEEDS] += dv
        if dq.any():
            moved[2 * _SPEEDS:N] += shear_follow(y, Coordinates(*dq.tolist()), self._leg)
        return moved

    def stepped(self, state: np.ndarray, forces: np.ndarray, seconds: float) -> np.ndarray:
        """Return the state after a Runge-Kutta step for each fifth."""
        y, is_held = self._of(state)
        for row in forces.tolist():
            y = leg_step(y, seconds / len(forces), tuple(row), is_held, self._leg)
        return np.array([*y, state[N] + seconds])


def crane_run(step_ms: float, mechanics: Tree | None = None) -> isa_ros.Run:
    """Return three equal cylinders on the crane; ``mechanics`` changes their load cells."""
    plant: Tree = {
        'drive': {'bore_mm': 50.0, 'rod_mm': 30.0, 'stroke_mm': STROKE_MM,
                  'rated_pressure_mpa': 14.0},
        'valve': {'flow': {'rated_flow_lpm': 20.0, 'rated_current_ma': 10.0}}}
    if mechanics is not None:
        plant['mechanics'] = mechanics
    return isa_ros.load({
        'name': 'crane', 'step_ms': step_ms, 'controller_offset_ms': 0.08,
        'supply': {'kind': 'constant', 'pressure_mpa': 14.0, 'return_pressure_mpa': 0.0},
        'body': {'kind': 'external', 'actuators': list(CRANE_NAMES)},
        'actuators': {name: {
            'model': 'cylinder', 'initial_position_mm': 0.5 * STROKE_MM,
            'parameters': {'plant': plant}} for name in CRANE_NAMES}})


def crane_model(timestep: float, integrator: str) -> tuple[Any, Any]:
    """Return model and data of the crane in MuJoCo, at its pose of t = 0."""
    import mujoco
    model = mujoco.MjModel.from_xml_string(
        CRANE_XML.format(timestep=timestep, integrator=integrator))
    data = mujoco.MjData(model)
    data.qpos[:] = np.radians(POSE_DEG)
    return model, data


def crane(timestep: float, integrator: str) -> Callable[[isa_ros.Mounting], Any]:
    """Return what makes the crane in MuJoCo."""
    def made(mounting: isa_ros.Mounting) -> Any:
        from isa_ros.mujoco import MujocoBody
        return MujocoBody(*crane_model(timestep, integrator), mounting)
    return made
