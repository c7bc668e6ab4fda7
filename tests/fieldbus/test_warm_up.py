"""The kernels of a run are compiled before its bus opens."""

import subprocess
import sys

from isa_ros.bench.child import environment
import pytest

PROGRAM = """
from pathlib import Path
import sys
import tempfile

from isa_ros.fieldbus.request import BusRequest
from isa_ros.fieldbus.session import prepare_bus
from isa_ros.config.paths import CONFIG, find
from isa_ros.run.options import Request
from isa_ros.run.without_ros import run_without_ros
from numba.core.dispatcher import Dispatcher
from tests.fieldbus.toy_line import ENABLE, ToyLine, toys_of

compile, late = Dispatcher.compile, []

def open_line(devices, step_ns):
    def compile_late(self, signature):
        late.append(self.py_func.__name__)
        return compile(self, signature)
    Dispatcher.compile = compile_late
    return ToyLine(devices, [(6, 0), *[(ENABLE, 100)] * 50])

with tempfile.TemporaryDirectory() as directory:
    request = Request(
        config=find('rig_linear', CONFIG), out=Path(directory) / 'bag', duration_s=0.04)
    session = prepare_bus(BusRequest(
        run=request, bus='ethercat'), toys_of, open_line, print).session
    run_without_ros(session, None, lambda: False)
print('late:', *late)
"""


@pytest.mark.slow
def test_nothing_is_compiled_once_the_bus_is_open():
    """A kernel that is compiled at a tick takes longer than a master waits for a frame."""
    ended = subprocess.run(
        [sys.executable, '-c', PROGRAM], env=environment(), capture_output=True, text=True,
        stdin=subprocess.DEVNULL, timeout=300.0)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.splitlines()[-1] == 'late:'
