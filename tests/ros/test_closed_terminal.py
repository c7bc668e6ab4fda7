"""A run whose terminal is closed: SIGHUP, and nothing can be printed any more."""

import os
import pty
import select
import signal
import sys

import pytest
from tests.ros.started import RIG, ROOT, wait_for

pytestmark = [pytest.mark.ros, pytest.mark.slow]


@pytest.mark.usefixtures('heard_hang_up')
def test_a_run_ends_with_130_and_a_whole_bag(domain, tmp_path):
    bag = tmp_path / 'bag'
    pid, terminal = pty.fork()
    if not pid:
        os.environ['PYTHONPATH'] = str(ROOT)
        os.execv(sys.executable, [
            sys.executable, '-m', 'isa_ros', 'bringup', str(RIG), '--in-process',
            '--real-time-factor', '1', '--out', str(bag)])
    shown = b''

    def has_progress() -> bool:
        nonlocal shown
        if select.select([terminal], [], [], 0.0)[0]:
            shown += os.read(terminal, 4096)
        return b't = ' in shown
    ended: list[int] = []

    def has_ended() -> bool:
        done, status = os.waitpid(pid, os.WNOHANG)
        if done:
            ended.append(os.waitstatus_to_exitcode(status))
        return bool(ended)
    try:
        wait_for(has_progress, 'the progress')
        os.close(terminal)
        wait_for(has_ended, 'the end of the run')
    finally:
        if not ended:
            os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)
    assert ended == [130]
    assert 'message_count' in (bag / 'metadata.yaml').read_text()
