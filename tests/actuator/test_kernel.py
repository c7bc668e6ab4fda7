"""The compiled tick equals its Python source bit for bit."""

import os
import subprocess
import sys

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.rows import Memory
from isa_ros.actuator.timing import Timing
import numba
import numpy as np
import pytest
from tests.sheets import actuator_sheet, MODELS, setpoint, smart_actuator

TICKS = 5
CASES = [
    *((model, 'blocked', ()) for model in MODELS),
    ('smart_manifold', 'wheel', ()), ('smart_manifold', 'drop_rig', ()),
    ('isa_v5', 'rubber', ()),
    ('isa_v5', 'blocked', ('explicit',)), ('isa_v2', 'wheel', ('feedback_linearisation',)),
    ('isa_v5', 'mass', ('data_sheet_sensors',))]
"""Model, load and variants."""


def state_after_ticks(model: str, kind: str, variants: tuple[str, ...]) -> str:
    """Return the state of an actuator that has moved, in hexadecimal digits."""
    sheet = actuator_sheet(model, 'default', *variants)
    actuator = smart_actuator(model, kind, sheet=sheet, timing=Timing(1_000_000, 120_000))
    if numba.config.DISABLE_JIT:
        use_records(actuator)
    actuator.accept(setpoint(position=0.6 * sheet.plant.drive.stroke, velocity=0.01))
    for _ in range(TICKS):
        actuator.tick()
    return actuator.snapshot().hex()


def use_records(actuator: SmartActuator) -> None:
    """Give the rows attributes, which they have in compiled kernels only."""
    actuator.memory = Memory(*(
        rows.view(np.recarray) if rows.dtype.names else rows for rows in actuator.memory))
    actuator._commands = actuator._commands.view(np.recarray)


@pytest.fixture(scope='module')
def states_from_python() -> list[str]:
    """Return the states of all cases without compiling, for which it takes another process."""
    done = subprocess.run(
        [sys.executable, '-W', 'ignore', '-m', __name__], check=True, capture_output=True,
        text=True, env=os.environ | {'NUMBA_DISABLE_JIT': '1'})
    return done.stdout.split()


@pytest.mark.parametrize('number', range(len(CASES)), ids=[' '.join(
    (model, kind, *variants)) for model, kind, variants in CASES])
def test_compiled_tick_equals_its_python_source(states_from_python, number):
    """Replay compares bytes: valve, oil, friction, sensors, loops and load copy are equal."""
    compiled = state_after_ticks(*CASES[number])
    assert len(compiled) > 1000
    assert compiled == states_from_python[number]


if __name__ == '__main__':
    assert numba.config.DISABLE_JIT
    for case in CASES:
        print(state_after_ticks(*case))
