"""The compiled tick equals its Python source bit for bit."""

import os
import subprocess
import sys

import pytest
from tests.sheets import MODELS

SCRIPT = """
import sys
import numpy as np
from isa_ros.actuator import Timing
from tests.sheets import setpoint, smart_actuator

model, kind, as_python = sys.argv[1], sys.argv[2], sys.argv[3] == 'python'
actuator = smart_actuator(model, kind, timing=Timing(1_000_000, 120_000))
if as_python:
    actuator._kernel_arguments = tuple(
        rows.view(np.recarray) if rows.dtype.names else rows
        for rows in actuator._kernel_arguments)
stroke = {'isa_v5': 0.1}.get(model, 1.745)
actuator.accept(setpoint(position=0.6 * stroke, velocity=0.01))
for _ in range(12):
    actuator.tick()
print(actuator.snapshot().hex())
"""


def run(model: str, kind: str, mode: str) -> str:
    """Return the state after 12 ticks, computed in a process of its own."""
    environment = dict(os.environ, NUMBA_DISABLE_JIT='1' if mode == 'python' else '0')
    return subprocess.run(
        [sys.executable, '-W', 'ignore', '-c', SCRIPT, model, kind, mode],
        env=environment, check=True, capture_output=True, text=True).stdout


@pytest.mark.parametrize(('model', 'kind'), [
    *[(model, kind) for model in MODELS for kind in ('wheel', 'blocked', 'rubber')],
    ('smart_manifold', 'drop_rig')])
def test_compiled_tick_equals_its_python_source(model, kind):
    """Replay compares bytes: valve, oil, friction, sensors, loops, load copy, all of it."""
    compiled = run(model, kind, 'compiled')
    assert len(compiled) > 1000
    assert compiled == run(model, kind, 'python')
