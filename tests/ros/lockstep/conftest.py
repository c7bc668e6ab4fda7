"""The transports of the ticks, and the ends of the participants."""

from isa_ros.nodes.lockstep import sockets as local_wire
from isa_ros.nodes.lockstep.participant_end import ParticipantEnd
import pytest


@pytest.fixture(params=['sockets', 'topics'], autouse=True)
def carrier(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Return the transport of the ticks: sockets on one host."""
    if request.param == 'topics':
        monkeypatch.setattr(local_wire, 'is_possible', lambda: False)
    return request.param


@pytest.fixture
def ends(monkeypatch) -> list[ParticipantEnd]:
    """Return a list of the participants' ends that are created from now on."""
    made: list[ParticipantEnd] = []
    make = ParticipantEnd.__init__

    def note(self: ParticipantEnd, *arguments: object) -> None:
        make(self, *arguments)
        made.append(self)
    monkeypatch.setattr(ParticipantEnd, '__init__', note)
    return made
