"""A crane of three cylinders in MuJoCo: an external body to measure."""

from collections.abc import Callable
from typing import Any

import isa_ros
from isa_ros.config.text.yaml_text import Tree
import numpy as np

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
