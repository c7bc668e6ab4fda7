"""What a node does with setpoints whose bytes are not a whole message."""

from types import SimpleNamespace
from typing import Any

from isa_ros.nodes.middleware.servers import DirectServer
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState

MESSAGE = JointState(name=['knee', 'knee/stiffness'], position=[1.0, 2.0], velocity=[3.0, 4.0])


def served(*messages: bytes) -> tuple[list[JointState], list[str]]:
    """Return the messages that reach a node, and what it logs."""
    waiting: list[Any] = [(one, None) for one in messages]
    callbacks: list[JointState] = []
    logged: list[str] = []
    subscription = SimpleNamespace(
        handle=SimpleNamespace(take_message=lambda *_: waiting.pop(0) if waiting else None),
        msg_type=JointState, topic_name='/knee/setpoint', callback=callbacks.append)
    log = SimpleNamespace(warning=lambda text, throttle_duration_sec: logged.append(text))
    DirectServer(log, [subscription], []).serve()       # type: ignore[arg-type, list-item]
    return callbacks, logged


def test_cut_setpoints_are_discarded_without_a_line_of_the_deserialiser(capfd):
    """The logger throttles its warning; Fast DDS would print a line for each such message."""
    whole = bytes(serialize_message(MESSAGE))
    cut = [whole[:k] for k in range(len(whole) - 8)]    # at most 8 bytes are behind its end
    callbacks, logged = served(*cut, whole)
    assert callbacks == [MESSAGE]
    assert logged == ['a message on /knee/setpoint is discarded: its bytes are not of its type'
                      ] * len(cut)
    assert capfd.readouterr() == ('', '')


def test_the_deserialiser_prints_lines_for_some_of_them(capfd):
    """Without that the test above would show nothing."""
    whole = bytes(serialize_message(MESSAGE))
    for k in range(4, len(whole)):
        try:
            deserialize_message(whole[:k], JointState)
        except Exception:   # noqa: B902
            continue
    if 'exceeds' not in capfd.readouterr().err:
        pytest.skip('this version of Fast DDS prints nothing')
