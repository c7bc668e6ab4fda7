"""An actuator with its messages, called directly."""

from isa_ros.config.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_SETPOINT, START
from isa_ros.errors import ConfigError
from isa_ros.run.exchange import Messages
from isa_ros.run.stepping import SteppedActuator
from msg_adapters.applied_parameters import tuned_values
from msg_adapters.cdr_reader import decode
import numpy as np
import pytest
from rcl_interfaces.msg import ParameterEvent
from sensor_msgs.msg import JointState

TUNED, APPLIED, JOINT_STATES = 0, 1, 0  # places in what is applied, and in the states


@pytest.fixture
def stepped() -> SteppedActuator:
    """Return an ISA v5 on its default load."""
    return SteppedActuator(default_actuator('isa_v5', 'knee'), DEFAULT_TIMING)


def stamp_ns(message: JointState) -> int:
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def said(stepped: SteppedActuator, applied: Messages) -> list[bytes | None]:
    """Return everything of this instant."""
    return [*applied, *stepped.states()]


def test_first_messages_are_of_t_0(stepped):
    """The state and the initial setpoint, both stamped 0; no parameter has changed."""
    applied = stepped.start(None)
    assert stamp_ns(decode(stepped.states()[JOINT_STATES], JointState)) == 0
    assert decode(applied[APPLIED], JointState).name[0] == 'knee'
    assert applied[TUNED] is None


def test_applied_setpoint_carries_the_tick_it_took_effect_at(stepped):
    """Accepted after tick 0: acts on [1 ms, 2 ms), so stamped 1 ms; the state carries 2 ms."""
    stepped.start(None)
    assert stepped.advance(None)[APPLIED] is None
    command = np.zeros(1, COMMAND)[0]
    command['kinds'], command['position'] = HAS_SETPOINT, 0.03
    command['stiffness'] = command['damping'] = np.nan
    stepped.actuator.accept(command)
    applied = decode(stepped.advance(None)[APPLIED], JointState)
    assert stamp_ns(applied) == 1_000_000
    assert applied.position[0] == 0.03
    assert stamp_ns(decode(stepped.states()[JOINT_STATES], JointState)) == 2_000_000
    assert stepped.advance(None)[APPLIED] is None


def test_applied_parameters_carry_the_tick_they_took_effect_at(stepped):
    """Of two values the last, of two equal ones none; only on change."""
    stepped.start(None)
    stepped.advance(None)
    stepped.actuator.tune({'force.kp': 1e-7, 'force.kf': 0.002})
    stepped.actuator.tune({'force.kp': 9e-8})
    data = stepped.advance(None)[TUNED]
    stamp = decode(data, ParameterEvent).stamp
    assert (stamp.sec, stamp.nanosec) == (0, 1_000_000)
    assert tuned_values(data, 'knee') == {'force.kp': 9e-8}
    assert stepped.advance(None)[TUNED] is None


def test_start_begins_anew(stepped):
    """A second run in the same object gives the first one's bytes."""
    start = np.zeros(1, START)[0]
    start['position'], start['supply_pressure'] = 0.02, 20.7e6

    def run() -> list[Messages]:
        messages = [said(stepped, stepped.start(start))]
        command = np.zeros(1, COMMAND)[0]
        command['kinds'] = HAS_ENABLE
        stepped.actuator.accept(command)
        stepped.actuator.tune({'force.kp': 1e-7})
        return messages + [said(stepped, stepped.advance(None)) for _ in range(3)]
    assert run() == run()


def test_a_restored_actuator_says_what_it_said_then(stepped):
    """State and what was applied at that instant, and the same bytes from then on."""
    stepped.start(None)
    stepped.actuator.tune({'force.kp': 1e-7})
    command = np.zeros(1, COMMAND)[0]
    command['kinds'] = HAS_ENABLE
    stepped.actuator.accept(command)
    then = said(stepped, stepped.advance(None))
    snapshot = stepped.actuator.snapshot()
    later = [said(stepped, stepped.advance(None)) for _ in range(3)]
    other = SteppedActuator(default_actuator('isa_v5', 'knee'), DEFAULT_TIMING)
    assert said(other, other.restore(snapshot)) == then
    assert then[APPLIED] is not None and then[TUNED] is not None
    assert [said(other, other.advance(None)) for _ in range(3)] == later


def test_a_cut_snapshot_is_refused(stepped):
    snapshot = stepped.actuator.snapshot()
    with pytest.raises(ConfigError, match=r'knee: saved state of \d+ bytes, must be'):
        stepped.restore(snapshot[:-1])
