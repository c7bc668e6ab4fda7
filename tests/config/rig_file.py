"""A run file with a cylinder and a rotary actuator, for the tests."""

from pathlib import Path

RIG = """\
name: rig
step_ms: {step}
controller_offset_ms: 0.12
tick_timeout_s: 5.0
supply: {{kind: constant, pressure_mpa: 20.7, return_pressure_mpa: 0.0}}
actuators:
  ram: {{{ram}}}
  rotor: {{model: smart_manifold, load: {{kind: wheel, inertia: 0.4}}}}
"""


def rig(tmp_path: Path, ram: str = 'model: isa_v5, load: {kind: mass}', step: str = '1') -> Path:
    """Return the file of a run with a cylinder and a rotary actuator."""
    path = tmp_path / 'rig.yaml'
    path.write_text(RIG.format(step=step, ram=ram), encoding='utf-8')
    return path
