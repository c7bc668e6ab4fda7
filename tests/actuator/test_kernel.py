"""The compiled tick equals its Python source bit for bit."""

import os
import subprocess
import sys

import pytest
from tests.sheets import MODELS

SCRIPT = """
import sys
import numpy as np
from isa_ros.actuator.actuator import Timing
from isa_ros.actuator.rows import Memory
from tests.sheets import actuator_sheet, setpoint, smart_actuator

model, kind, mode, *variants = sys.argv[1:]
sheet = actuator_sheet(model, 'default', *variants)
actuator = smart_actuator(model, kind, sheet=sheet, timing=Timing(1_000_000, 120_000))
if mode == 'python':
    actuator.memory = Memory(*(
        rows.view(np.recarray) if rows.dtype.names else rows for rows in actuator.memory))
    actuator._commands = actuator._commands.view(np.recarray)
stroke = sheet.plant.drive.stroke
actuator.accept(setpoint(position=0.6 * stroke, velocity=0.01))
for _ in range(5):
    actuator.tick()
print(actuator.snapshot().hex())
"""


def run(model: str, kind: str, mode: str, variants: tuple[str, ...]) -> str:
    """Return the state after 5 ticks, computed in a process of its own."""
    environment = dict(os.environ, NUMBA_DISABLE_JIT='1' if mode == 'python' else '0')
    return subprocess.run(
        [sys.executable, '-W', 'ignore', '-c', SCRIPT, model, kind, mode, *variants],
        env=environment, check=True, capture_output=True, text=True).stdout


@pytest.mark.parametrize(('model', 'kind', 'variants'), [
    *[(model, 'blocked', ()) for model in MODELS],
    ('smart_manifold', 'wheel', ()), ('smart_manifold', 'drop_rig', ()),
    ('isa_v5', 'rubber', ()),
    ('isa_v5', 'blocked', ('explicit',)), ('isa_v2', 'wheel', ('feedback_linearisation',))])
def test_compiled_tick_equals_its_python_source(model, kind, variants):
    """Replay compares bytes: valve, oil, friction, sensors, loops and load copy are equal."""
    compiled = run(model, kind, 'compiled', variants)
    assert len(compiled) > 1000
    assert compiled == run(model, kind, 'python', variants)
