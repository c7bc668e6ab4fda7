"""A process that starts without BLAS has the same kernels, and scipy when it asks for it."""

import subprocess
import sys

PROGRAM = """
import sys
from isa_ros.core.without_blas import start_without_blas
{start}
from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.actuator.actuator import SmartActuator
actuator = SmartActuator(default_actuator('isa_v5', 'ram'), DEFAULT_TIMING)
for _ in range(5):
    actuator.tick()
print('scipy.linalg' in sys.modules)
print(actuator.snapshot().hex())
import scipy.linalg
print(scipy.linalg.det([[2.0, 0.0], [0.0, 3.0]]))
"""


def printed(start: str) -> list[str]:
    """Return the lines of a process of its own."""
    return subprocess.run(
        [sys.executable, '-c', PROGRAM.format(start=start)], check=True, capture_output=True,
        text=True).stdout.splitlines()


def test_scipy_is_not_loaded_and_the_bytes_are_the_same():
    with_blas, without = printed(''), printed('start_without_blas()')
    assert (with_blas[0], without[0]) == ('True', 'False')
    assert with_blas[1] == without[1]
    assert with_blas[2] == without[2] == '6.0'


def test_where_scipy_is_loaded_already_nothing_is_changed():
    assert printed('import scipy; start_without_blas()')[2] == '6.0'
