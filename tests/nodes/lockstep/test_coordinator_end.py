"""The coordinator's end: answers by any way are noted where those at the board are awaited."""

from types import SimpleNamespace

from isa_ros.nodes.lockstep.coordinator_end import LockstepTransport
from isa_ros.run.wire.answers import AnswerKind


def test_each_answer_is_noted_once_it_is_taken():
    """Else the next wait would be one at the board, where nothing is to come."""
    noted = []
    answers = {b'of kfe': SimpleNamespace(participant=2, parts=(b'force',)), b'of none': None,
               b'of haa': SimpleNamespace(participant=0, parts=(b'torque',))}
    own = SimpleNamespace(
        _remote=[0, 2], _run_id=7, _awaited=None, _rounds=SimpleNamespace(note=noted.append),
        _answers=SimpleNamespace(decoded=lambda data, run_id: answers[data],
                                 is_awaited=lambda *_: True))
    found = LockstepTransport._gather(own, AnswerKind.DONE, arrived=[*answers])
    assert found == {2: (b'force',), 0: (b'torque',)} and noted == [2, 0]
