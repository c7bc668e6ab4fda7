"""All actuators of a run in this process, called directly."""

from isa_ros.config.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.core.signals import HAS_SETPOINT, START
from isa_ros.errors import ConfigError
from isa_ros.run.exchange import Messages, Rows, Silence
from isa_ros.run.group import ActuatorGroup
from isa_ros.run.in_process import LocalTransport
from msg_adapters.actuator_messages import TOPICS
from msg_adapters.cdr_reader import decode
import numpy as np
import pytest
from sensor_msgs.msg import JointState

NAMES = ('hip', 'knee')
APPLIED = [name for name, _ in TOPICS].index('applied_setpoint')
JOINT_STATES = [name for name, _ in TOPICS].index('joint_states')


class Outlet:
    """A node that says when it was called, and keeps what it was given."""

    def __init__(self, name: str, log: list[str]) -> None:
        self._name, self._log = name, log
        self.published: list[list[bytes | None]] = []

    def publish(self, applied: Messages, states: Messages) -> None:
        self._log.append(f'{self._name} publishes')
        self.published.append([*applied, *states])

    def serve(self) -> None:
        self._log.append(f'{self._name} serves')


@pytest.fixture
def log() -> list[str]:
    """Return what the outlets were asked, in order."""
    return []


@pytest.fixture
def outlets(log) -> list[Outlet]:
    """Return an outlet for each actuator."""
    return [Outlet(name, log) for name in NAMES]


def make_transport(outlets) -> LocalTransport:
    """Return two actuators that start at places of their own."""
    starts = np.zeros(len(NAMES), START)
    starts['position'], starts['supply_pressure'] = (0.03, 0.04), 20.7e6
    group = ActuatorGroup([default_actuator('isa_v5', name) for name in NAMES], DEFAULT_TIMING)
    return LocalTransport(group, starts, Silence(), outlets)


def make_rows() -> Rows:
    """Return the memory of a run in which only the second actuator is commanded."""
    rows = Rows(len(NAMES))
    rows.ports['supply_pressure'] = 20.7e6
    rows.commands['stiffness'] = rows.commands['damping'] = np.nan
    rows.commands['kinds'], rows.commands['position'] = (0, HAS_SETPOINT), 0.05
    return rows


def test_everyone_starts_where_its_row_says(outlets):
    rows = make_rows()
    first = make_transport(outlets).join(rows)
    assert [decode(messages[JOINT_STATES], JointState).position[0] for messages in first] == (
        rows.samples['position'].tolist()) == [pytest.approx(0.03, abs=1e-6),
                                               pytest.approx(0.04, abs=1e-6)]
    # All but the parameters, which are as the configuration says.
    assert [[message is None for message in messages] for messages in first] == [
        [True, *(len(first[0]) - 1) * [False]]] * 2


def test_all_serve_their_inputs_before_the_tick_and_publish_after_it(log, outlets):
    """What is published is what is returned to be recorded."""
    rows, transport = make_rows(), make_transport(outlets)
    first = transport.join(rows)
    transport.begin()
    transport.send(0, rows)
    said = transport.receive(rows)
    assert log == ['hip publishes', 'knee publishes',
                   'hip serves', 'knee serves', 'hip publishes', 'knee publishes']
    assert [[list(own) for own in messages] for messages in (first, said)] == [
        [outlet.published[k] for outlet in outlets] for k in (0, 1)]


def test_a_command_reaches_its_actuator_alone():
    rows, transport = make_rows(), make_transport(())
    transport.join(rows)
    hip, knee = transport.receive(rows)
    assert hip[APPLIED] is None
    assert decode(knee[APPLIED], JointState).position[0] == 0.05
    assert rows.replies['position'].tolist() != [0.0, 0.0]


def test_each_goes_on_from_its_own_snapshot(outlets):
    """What is published first is of the instant it goes on from, and the rest is the same."""
    rows, transport = make_rows(), make_transport(())
    transport.join(rows)
    then = transport.receive(rows)
    snapshots, replies = transport.snapshots(), rows.replies.copy()
    rows.commands['kinds'] = 0
    later = [transport.receive(rows) for _ in range(3)]
    other, fresh = make_transport(outlets), make_rows()
    other.join(fresh)
    assert other.restore(1, snapshots, fresh) == then
    assert fresh.replies.tobytes() == replies.tobytes()
    other.begin()
    assert [outlet.published for outlet in outlets] == [[list(messages)] for messages in then]
    fresh.commands['kinds'] = 0
    assert [other.receive(fresh) for _ in range(3)] == later
    with pytest.raises(ConfigError, match='the saved state has 1 participants, the run has 2'):
        other.restore(7, snapshots[:1], fresh)
