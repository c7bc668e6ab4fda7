"""Actuators with their messages, called directly."""

from isa_ros.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.errors import ConfigError
from isa_ros.exchange import Messages, Rows, Silence
from isa_ros.signals import COMMAND, HAS_ENABLE, HAS_SETPOINT, LOAD_REPLY, SAMPLE, START
from isa_ros.stepping import LocalTransport, SteppedActuator
from msg_adapters.cdr_reader import decode
import numpy as np
import pytest
from sensor_msgs.msg import JointState

APPLIED, JOINT_STATES = 0, 1  # places in the sorted topics


@pytest.fixture
def stepped() -> SteppedActuator:
    """Return an ISA v5 on its default load."""
    return SteppedActuator(default_actuator('isa_v5', 'knee'), DEFAULT_TIMING)


def stamp_ns(message: JointState) -> int:
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def test_topics_are_sorted(stepped):
    names = [name for name, _ in stepped.topics]
    assert names == sorted(names)
    assert (names[APPLIED], names[JOINT_STATES]) == ('applied_setpoint', 'joint_states')


def test_first_messages_are_of_t_0(stepped):
    """The state and the initial setpoint, both stamped 0."""
    messages = stepped.start(None)
    assert all(message is not None for message in messages)
    assert stamp_ns(decode(messages[JOINT_STATES], JointState)) == 0
    assert decode(messages[APPLIED], JointState).name[0] == 'knee'


def test_applied_setpoint_carries_the_tick_it_took_effect_at(stepped):
    """Accepted after tick 0: acts on [1 ms, 2 ms), so stamped 1 ms; the state carries 2 ms."""
    stepped.start(None)
    assert stepped.advance(None)[APPLIED] is None
    command = np.zeros(1, COMMAND)[0]
    command['kinds'], command['position'] = HAS_SETPOINT, 0.03
    command['stiffness'] = command['damping'] = np.nan
    stepped.actuator.accept(command)
    messages = stepped.advance(None)
    applied = decode(messages[APPLIED], JointState)
    assert stamp_ns(applied) == 1_000_000
    assert applied.position[0] == 0.03
    assert stamp_ns(decode(messages[JOINT_STATES], JointState)) == 2_000_000
    assert stepped.advance(None)[APPLIED] is None


def test_start_begins_anew(stepped):
    """A second run in the same object gives the first one's bytes."""
    start = np.zeros(1, START)[0]
    start['position'], start['supply_pressure'] = 0.02, 20.7e6

    def run() -> list[Messages]:
        messages = [stepped.start(start)]
        command = np.zeros(1, COMMAND)[0]
        command['kinds'] = HAS_ENABLE
        stepped.actuator.accept(command)
        return messages + [stepped.advance(None) for _ in range(3)]
    assert run() == run()


def test_a_restored_actuator_says_what_it_said_then(stepped):
    """State and applied setpoint of that instant, and the same bytes from then on."""
    stepped.start(None)
    command = np.zeros(1, COMMAND)[0]
    command['kinds'] = HAS_ENABLE
    stepped.actuator.accept(command)
    then, snapshot = stepped.advance(None), stepped.actuator.snapshot()
    later = [stepped.advance(None) for _ in range(3)]
    other = SteppedActuator(default_actuator('isa_v5', 'knee'), DEFAULT_TIMING)
    assert other.restore(snapshot) == then
    assert then[APPLIED] is not None
    assert [other.advance(None) for _ in range(3)] == later


def test_a_cut_snapshot_is_refused(stepped):
    snapshot = stepped.actuator.snapshot()
    with pytest.raises(ConfigError, match=r'knee: saved state of \d+ bytes, must be'):
        stepped.restore(snapshot[:-1])


class Scripted:
    """A participant that says when it was called."""

    digest = ''

    def __init__(self, name: str, log: list[str]) -> None:
        self.name, self.log = name, log
        self.reply, self.sample = np.zeros(1, LOAD_REPLY)[0], np.zeros(1, SAMPLE)[0]

    def start(self, start: np.void | None) -> Messages:
        self.log.append(f'{self.name} starts at {start["position"]:g}')
        self.sample['position'] = start['position']
        return [b'first']

    def advance(self, port: np.void | None, command: np.void | None) -> Messages:
        self.log.append(f'{self.name} {port["x0"]:g} {command["kinds"]}')
        self.reply['force'] = port['x0']
        return [b'%d' % port['x0']]

    def snapshot(self) -> bytes:
        return self.name.encode()

    def restore(self, snapshot: bytes) -> Messages:
        self.log.append(f'{self.name} goes on from {snapshot.decode()}')
        return [b'then']

    def publish(self, messages: Messages) -> None:
        self.log.append(f'{self.name} publishes {messages[0].decode()}')

    def serve(self) -> None:
        self.log.append(f'{self.name} serves')


@pytest.fixture
def log() -> list[str]:
    """Return what the steppers were asked, in order."""
    return []


@pytest.fixture
def transport(log) -> LocalTransport:
    """Return two scripted steppers in one process."""
    starts = np.zeros(2, START)
    starts['position'] = 1.0, 2.0
    return LocalTransport([Scripted('b', log), Scripted('a', log)], starts, Silence())


def test_local_transport_calls_in_order(log, transport):
    """Each serves its inputs, advances and publishes before the next one does."""
    rows = Rows(2)
    rows.ports['x0'], rows.commands['kinds'] = (3.0, 4.0), (0, 1)
    assert transport.join(rows) == [[b'first'], [b'first']]
    assert rows.samples['position'].tolist() == [1.0, 2.0]
    transport.begin()
    transport.send(5, rows)
    assert transport.receive(rows) == [[b'3'], [b'4']]
    assert rows.replies['force'].tolist() == [3.0, 4.0]
    assert log == [
        'b starts at 1', 'a starts at 2', 'b publishes first', 'a publishes first',
        'b serves', 'b 3 0', 'b publishes 3', 'a serves', 'a 4 1', 'a publishes 4']


def test_local_transport_restores_each_from_its_own(log, transport):
    """What is published first is of the instant it goes on from."""
    rows = Rows(2)
    transport.join(rows)
    log.clear()
    assert transport.restore(7, transport.snapshots(), rows) == [[b'then'], [b'then']]
    transport.begin()
    assert log == ['b goes on from b', 'a goes on from a', 'b publishes then', 'a publishes then']
    with pytest.raises(ConfigError, match='the saved state has 1 participants, the run has 2'):
        transport.restore(7, [b'b'], rows)
