"""A stop request: the signals that set it, and what they do before and after."""

import os
import signal

from isa_ros.processes.stopping import StopRequest
import pytest

pytestmark = pytest.mark.usefixtures('heard_hang_up')
SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]


@pytest.mark.parametrize('number', SIGNALS)
def test_a_signal_is_a_request(number):
    before = signal.getsignal(number)
    with StopRequest() as should_stop:
        assert not should_stop()
        os.kill(os.getpid(), number)
        assert should_stop()
    assert signal.getsignal(number) is before


def test_nohup_is_respected():
    """A run that shall outlive its terminal ignores the end of it."""
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with StopRequest() as should_stop:
            os.kill(os.getpid(), signal.SIGHUP)
            assert not should_stop()
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)
