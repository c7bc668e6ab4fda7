"""Waiting for frames on a real socket: how a wait ends."""

from collections.abc import Iterator
import select
import socket
import struct

from isa_ros.fieldbus.ethercat.line import EthercatLine
from isa_ros.fieldbus.ethercat.ring import Ring
import pytest
from tests.fieldbus.ethercat.raw_master import STEP_NS
from tests.fieldbus.toys import Toy

STRANGE = b'\xff' * 12 + b'\x08\x00' + bytes(46)    # a frame of another protocol


class Waits:
    """A line on one end of a pair of sockets, and how it has waited."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        own, self.master = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.own = own
        self.line = EthercatLine(Ring((Toy(),), STEP_NS), own, 'wire')
        self.selected: list[float] = []
        wait = select.select

        def noted(*arguments: object) -> object:
            self.selected.append(arguments[-1])
            return wait(*arguments)
        monkeypatch.setattr(select, 'select', noted)

    @property
    def own_timeout(self) -> float:
        """Return the timeout that the socket itself has, s; 0: none."""
        s, us = struct.unpack('@ll', self.own.getsockopt(
            socket.SOL_SOCKET, socket.SO_RCVTIMEO, 16))
        return s + 1e-6 * us


@pytest.fixture
def waits(monkeypatch: pytest.MonkeyPatch) -> Iterator[Waits]:
    """Yield a line that nothing is sent to."""
    made = Waits(monkeypatch)
    yield made
    made.line.close()
    made.master.close()


def test_a_short_wait_ends_by_a_timer_of_microseconds(waits: Waits) -> None:
    """The timeout of a socket would last until a tick of the kernel's timer, 4 ms of 1 ms."""
    assert not waits.line.serve(0.0006)
    assert waits.selected == [0.0006] and waits.own_timeout == 0.0


def test_a_long_wait_is_one_call_a_frame(waits: Waits) -> None:
    """In frame pace, where frames come and the timeout does not matter."""
    assert not waits.line.serve(0.06)
    assert waits.selected == [] and waits.own_timeout == pytest.approx(0.06, abs=0.01)


def test_no_wait_is_neither(waits: Waits) -> None:
    assert not waits.line.serve(0.0)
    assert waits.selected == [] and waits.own_timeout == 0.0


def test_what_is_left_of_a_wait_follows_a_frame(waits: Waits) -> None:
    """Frames of other protocols do not make it longer."""
    for _ in range(3):
        waits.master.send(STRANGE)
    assert not waits.line.serve(0.02)
    first, *rest = waits.selected
    assert first == 0.02 and len(rest) == 3
    assert 0.02 > rest[0] > rest[1] > rest[2] > 0.0
