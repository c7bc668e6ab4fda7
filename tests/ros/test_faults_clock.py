"""A jump of the host's clock changes neither a byte of the bag nor the duration of the run."""

from pathlib import Path
import shutil
import struct
import subprocess
import sys

import pytest
from tests.ros.bags import sha256
from tests.ros.faults import wait_for_chunk, WHEEL_SINE
from tests.ros.started import bringup, DEADLINE_S

pytestmark = [pytest.mark.ros, pytest.mark.slow]
SOURCE = Path(__file__).with_name('jumping_clock.c')
HOUR_S = 3600


class HostClock:
    """The clock of all processes that are started from now on."""

    def __init__(self, directory: Path, patch: pytest.MonkeyPatch) -> None:
        library = directory / 'jumping_clock.so'
        subprocess.run(['cc', '-shared', '-fPIC', '-o', str(library), str(SOURCE), '-ldl'],
                       check=True, timeout=DEADLINE_S)
        self._shift = directory / 'shift'
        self._shift.write_bytes(struct.pack('<q', 0))
        patch.setenv('LD_PRELOAD', str(library))
        patch.setenv('ISA_ROS_CLOCK_SHIFT', str(self._shift))

    def jump_to(self, seconds: int) -> None:
        """Set it ``seconds`` ahead of its value at the start."""
        with self._shift.open('r+b') as file:
            file.write(struct.pack('<q', seconds))


@pytest.fixture
def host_clock(tmp_path, monkeypatch) -> HostClock:
    """Return a clock that jumps, for the processes that the test starts."""
    if shutil.which('cc') is None:
        pytest.skip('a clock that jumps is compiled with cc')
    return HostClock(tmp_path, monkeypatch)


def read_clock() -> float:
    """Return the time that a process reads now."""
    return float(subprocess.run(
        [sys.executable, '-c', 'import time; print(time.time())'], capture_output=True,
        text=True, check=True, timeout=DEADLINE_S).stdout)


def test_a_jump_of_the_host_clock_changes_nothing(
        domain, tmp_path, patient_rig, undisturbed, host_clock):
    """
    An hour forward, two back and one forward, in the nodes and in the middleware's threads.

    The hour back is short, since the middleware's threads do not sleep during it.
    """
    bag = tmp_path / 'bag'
    with bringup(bag, *WHEEL_SINE, '--real-time-factor', '1', config=patient_rig) as run:
        before = read_clock()
        wait_for_chunk(bag, run)
        host_clock.jump_to(HOUR_S)
        assert HOUR_S <= read_clock() - before < HOUR_S + DEADLINE_S
        wait_for_chunk(bag, run)
        host_clock.jump_to(-HOUR_S)
        assert read_clock() < before
        host_clock.jump_to(0)
        assert run.exit_code() == 0, run.errors
    assert sha256(bag) == sha256(undisturbed)
