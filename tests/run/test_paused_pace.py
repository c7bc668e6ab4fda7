"""A paused run continues at its pace: it does not catch up on the time of the pause."""

from isa_ros.run.coordinator import Coordinator
from isa_ros.run.pacing import Pace
import pytest
from tests.run.rig import Rig
from tests.run.test_pacing import Host

PAUSE_S = 60.0
N = 8


def test_the_ticks_after_a_pause_are_as_far_apart_as_before():
    """
    Eight ticks of 1 ms at real time, a minute's pause in front of the fourth.

    That tick was due when the run was paused and is due at once when it goes on, as the first;
    each of the others waits for its millisecond. The host's clock rounds to 1e-14 s.
    """
    host = Host()
    rig = Rig(N, Pace(1.0, host.time, host.sleep))

    def resume(run: Coordinator) -> None:
        host.now += PAUSE_S
        run.pause(False)
    rig.asked = {3: lambda run: run.pause(True), 5: resume}
    rig.run()
    assert host.naps == pytest.approx([1e-3] * (N - 2), abs=1e-9)
    assert host.now == pytest.approx(100.0 + PAUSE_S + (N - 2) * 1e-3, abs=1e-9)
